"""Advice on the size of elements, from one reference image and the noise."""

from fedic.advise.advice import Advice
from fedic.advise.element_size import SIZES, advise_element_size
from fedic.advise.texture import Texture

__all__ = ["SIZES", "Advice", "Texture", "advise_element_size"]
