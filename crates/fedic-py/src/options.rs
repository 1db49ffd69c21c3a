//! Options from keyword arguments, and the tables that describe them.

use fedic::{OptionError, OptionInfo, OptionKind, OptionValue, Options, SelfCalibrationOptions};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};

use crate::arrays::representation;
use crate::errors::option_error;

/// Options of a correlation from keyword arguments.
pub(crate) fn correlation_options(arguments: Option<&Bound<'_, PyDict>>) -> PyResult<Options> {
    let mut options = Options::default();
    set_all(arguments, &Options::info(), |name, value| options.set(name, value))?;
    Ok(options)
}

/// Options of a specimen calibration from keyword arguments.
pub(crate) fn specimen_options(arguments: Option<&Bound<'_, PyDict>>) -> PyResult<SelfCalibrationOptions> {
    let mut options = SelfCalibrationOptions::default();
    set_all(arguments, &SelfCalibrationOptions::info(), |name, value| options.set(name, value))?;
    Ok(options)
}

fn set_all(
    arguments: Option<&Bound<'_, PyDict>>,
    table: &[OptionInfo],
    mut set: impl FnMut(&str, &OptionValue) -> Result<(), OptionError>,
) -> PyResult<()> {
    for (name, argument) in arguments.into_iter().flatten() {
        let name: String = name.extract()?;
        let outcome = match (read(&argument), table.iter().find(|info| info.name == name)) {
            (None, Some(info)) => Err(OptionError::invalid(info.name, info.expected(), &"")),
            (value, _) => set(&name, &value.unwrap_or(OptionValue::None)),
        };
        outcome.map_err(|error| refusal(error, table, &argument))?;
    }
    Ok(())
}

/// The value of a Python object; `None` if it has a type that no option has.
fn read(argument: &Bound<'_, PyAny>) -> Option<OptionValue> {
    if argument.is_none() {
        Some(OptionValue::None)
    } else if argument.is_instance_of::<PyBool>() {
        argument.extract().ok().map(OptionValue::Flag)
    } else if argument.is_instance_of::<PyString>() {
        argument.extract().ok().map(OptionValue::Name)
    } else if !argument.is_instance_of::<PyFloat>()
        && let Ok(integer) = argument.extract::<i64>()
    {
        Some(OptionValue::Integer(integer))
    } else if let Ok(number) = argument.extract::<f64>() {
        Some(OptionValue::Number(number))
    } else {
        argument.extract().ok().map(|(name, factor)| OptionValue::Scaled(name, factor))
    }
}

/// The exception for an argument that an option refuses, in Python's spelling: `None` where an option may be absent.
fn refusal(error: OptionError, table: &[OptionInfo], argument: &Bound<'_, PyAny>) -> PyErr {
    let OptionError::Invalid { option, mut expected, .. } = error else { return option_error(error.to_string(), "") };
    expected = expected.replace("\"none\"", "None");
    if table.iter().any(|info| info.name == option && info.optional) {
        expected += " or None";
    }
    option_error(format!("{option} must be {expected}, got {}", shown(option, argument)), option)
}

/// The representation of an argument, shortened; of a pair the number, when that is at fault.
fn shown(option: &str, argument: &Bound<'_, PyAny>) -> String {
    let number = argument.extract::<(String, Bound<'_, PyAny>)>().ok().filter(|_| option == "density");
    let value = number.map_or_else(|| argument.clone(), |(_, number)| number);
    representation(&value)
}

/// Checks the options of a correlation.
///
/// Raises
/// ------
/// OptionError
///     If an option is unknown, or a value has the wrong type or lies outside the range.
#[pyfunction]
#[pyo3(signature = (**options))]
pub(crate) fn check_correlation_options(options: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
    correlation_options(options).map(|_| ())
}

/// One option: its name, values, default and documentation.
#[pyclass(frozen, module = "fedic._core", name = "OptionInfo")]
pub(crate) struct PyOptionInfo(OptionInfo);

#[pymethods]
impl PyOptionInfo {
    /// Name of the keyword argument.
    #[getter]
    fn name(&self) -> &str {
        self.0.name
    }

    /// Kind of the values: "flag", "integer", "number", "choice" or "quadrature".
    #[getter]
    fn kind(&self) -> &str {
        match self.0.kind {
            OptionKind::Flag => "flag",
            OptionKind::Integer => "integer",
            OptionKind::Number => "number",
            OptionKind::Choice => "choice",
            OptionKind::Quadrature => "quadrature",
            _ => "other",
        }
    }

    /// Whether the option may be None.
    #[getter]
    fn optional(&self) -> bool {
        self.0.optional
    }

    /// Names that it takes.
    #[getter]
    fn choices(&self) -> Vec<&str> {
        self.0.choices.clone()
    }

    /// Least number, and whether that number itself is excluded.
    #[getter]
    fn minimum(&self) -> Option<(f64, bool)> {
        self.0.range.map(|range| (range.min, range.above_min))
    }

    /// Largest number.
    #[getter]
    fn maximum(&self) -> Option<f64> {
        self.0.range.map(|range| range.max).filter(|max| max.is_finite())
    }

    /// Values that it takes, in words.
    #[getter]
    fn expected(&self) -> String {
        self.0.expected()
    }

    /// Default value; a name and a factor for a quadrature.
    #[getter]
    fn default<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.0.default {
            OptionValue::Flag(flag) => Ok(PyBool::new(py, *flag).to_owned().into_any()),
            OptionValue::Integer(integer) => Ok(PyInt::new(py, *integer).into_any()),
            OptionValue::Number(number) => Ok(PyFloat::new(py, *number).into_any()),
            OptionValue::Name(name) => Ok(PyString::new(py, name).into_any()),
            OptionValue::Scaled(name, factor) => Ok((name, *factor).into_pyobject(py)?.into_any()),
            _ => Ok(py.None().into_bound(py)),
        }
    }

    /// Documentation, Markdown.
    #[getter]
    fn doc(&self) -> &str {
        self.0.doc
    }
}

/// Adds the tables of options to the module.
pub(crate) fn add_tables(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let table = |table: Vec<OptionInfo>| table.into_iter().map(PyOptionInfo).collect::<Vec<_>>();
    module.add("CORRELATION_OPTIONS", table(Options::info()))?;
    module.add("SPECIMEN_OPTIONS", table(SelfCalibrationOptions::info()))
}
