"""Validity and quality of elements: certified bounds of det J, and measures of every element."""

from hoblock.quality.bad_elements import BadElement, bad_elements, invalid_elements
from hoblock.quality.certificate import (
    INVALID,
    STATUS_NAMES,
    UNDECIDED,
    VALID,
    Certificate,
    certify,
    det_jacobian_bounds,
)
from hoblock.quality.jacobian import det_jacobian, jacobian, minimum_det_jacobian
from hoblock.quality.measures import (
    aspect_ratio,
    element_areas,
    equiangular_skewness,
    jacobian_ratio,
    scaled_jacobian,
)
from hoblock.quality.neighbours import size_jump
from hoblock.quality.summary import (
    Histogram,
    MeasureSummary,
    QualitySummary,
    WorstElement,
    histogram,
    per_element,
    quality_summary,
)

__all__ = [
    "BadElement",
    "Certificate",
    "Histogram",
    "INVALID",
    "MeasureSummary",
    "QualitySummary",
    "STATUS_NAMES",
    "UNDECIDED",
    "VALID",
    "WorstElement",
    "aspect_ratio",
    "bad_elements",
    "certify",
    "det_jacobian",
    "det_jacobian_bounds",
    "element_areas",
    "equiangular_skewness",
    "histogram",
    "invalid_elements",
    "jacobian",
    "jacobian_ratio",
    "minimum_det_jacobian",
    "per_element",
    "quality_summary",
    "scaled_jacobian",
    "size_jump",
]
