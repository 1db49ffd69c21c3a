//! Long work away from the interpreter lock, with Ctrl-C and progress alive.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::Builder;
use std::time::Duration;

use fedic::{Error, Monitor, Progress, Stage, ThreadPool};
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::errors::{IntoPyErr, internal_error};

/// How often signals are looked at.
const TICK: Duration = Duration::from_millis(50);

/// Threads of all work that does not have its own.
pub(crate) static SHARED: ThreadPool = ThreadPool::new(None);

struct Channel {
    cancelled: AtomicBool,
    progress: Sender<Progress>,
}

impl Monitor for Channel {
    fn progress(&self, progress: &Progress) {
        // The receiver lives as long as the work: it can only be gone when nobody listens any more.
        let _ = self.progress.send(*progress);
    }

    fn cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

/// Runs `work` away from the interpreter lock, its parallel loops on the shared threads; see [`run_on`].
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&dyn Monitor) -> Result<T, Error> + Send,
) -> PyResult<T> {
    run_on(py, Some(&SHARED), progress, work)
}

/// Runs short work on the threads of `pool` without the interpreter lock.
pub(crate) fn run_briefly<T: Send>(py: Python<'_>, pool: &ThreadPool, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| pool.install(work)).map_err(IntoPyErr::into_py_err)
}

/// Runs `work` on the threads of `pool` without the interpreter lock; without a pool the work has threads of its own.
///
/// Meanwhile this thread looks for signals and hands every step on to the Python function `progress(stage, level,
/// iteration, correction, residual_rms)`. An exception in either stops the work and is raised.
pub(crate) fn run_on<T: Send>(
    py: Python<'_>,
    pool: Option<&ThreadPool>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&dyn Monitor) -> Result<T, Error> + Send,
) -> PyResult<T> {
    let (sender, receiver) = channel();
    let monitor = Channel { cancelled: AtomicBool::new(false), progress: sender };
    let callback = progress.map(|function| function.clone().unbind());
    py.detach(move || {
        std::thread::scope(|scope| {
            let (done, ended) = channel::<()>();
            let monitor = &monitor;
            let worker = Builder::new().spawn_scoped(scope, move || {
                // Dropped when the work ends, however it ends.
                let _done = done;
                match pool {
                    Some(pool) => pool.install(|| work(monitor))?,
                    None => work(monitor),
                }
            });
            let worker = worker.map_err(|error| {
                internal_error(format!("no thread can be started ({error}); close other programs, or raise the limit"))
            })?;
            let attended = attend(&receiver, &ended, callback.as_ref());
            if attended.is_err() {
                monitor.cancelled.store(true, Ordering::Relaxed);
            }
            let result = worker.join();
            attended?;
            match result {
                Ok(result) => result.map_err(IntoPyErr::into_py_err),
                Err(_) => Err(internal_error("fedic failed in its core; please report it with the data".to_owned())),
            }
        })
    })
}

fn attend(receiver: &Receiver<Progress>, ended: &Receiver<()>, callback: Option<&Py<PyAny>>) -> PyResult<()> {
    loop {
        let over = matches!(ended.recv_timeout(TICK), Err(RecvTimeoutError::Disconnected));
        let steps: Vec<Progress> = receiver.try_iter().collect();
        Python::attach(|py| {
            py.check_signals()?;
            let Some(function) = callback else { return Ok(()) };
            for p in &steps {
                let stage = match p.stage {
                    Stage::Prepare => "prepare",
                    Stage::Pyramid => "pyramid",
                    Stage::Solve => "solve",
                };
                function.call1(py, (stage, p.level, p.iteration, p.correction, p.residual_rms))?;
            }
            Ok::<(), PyErr>(())
        })?;
        if over {
            return Ok(());
        }
    }
}
