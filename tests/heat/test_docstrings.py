"""Every public function of the heat library says what it takes, in which units, what it gives and what it refuses."""

import inspect
import re

import pytest

from bedrad import heat

FUNCTIONS = {
    f"{module}.{name}": getattr(getattr(heat, module), name)
    for module in heat.__all__
    if module != "RangeWarning"
    for name in getattr(heat, module).__all__
    if inspect.isfunction(getattr(getattr(heat, module), name))
}
ONE_LINERS = {"flow_correlations.warn_outside_fit", "systems.check_correlation"}
"""Helpers of a line or two, which say all in one."""

WITHOUT_UNITS = re.compile(
    r"over|ratio|number|factor|fraction|share|porosity|emissivity|exponent|radi[iu]|-", re.IGNORECASE
)


def test_there_are_many():
    assert len(FUNCTIONS) > 180


@pytest.mark.parametrize("name", sorted(set(FUNCTIONS) - ONE_LINERS))
def test_parameters_results_and_units_are_told(name):
    function = FUNCTIONS[name]
    text = inspect.getdoc(function) or ""
    referred = "Takes what `" in text
    parameters = inspect.signature(function).parameters.values()
    assert "Returns\n-------" in text
    for parameter in parameters:
        assert referred or re.search(rf"\b{parameter.name}\b", text), parameter.name
    if not referred and parameters:
        assert "Parameters\n----------" in text
    # a quantity with a unit somewhere, or nothing but numbers without one
    assert re.search(r"\[[^\]]*(m|K|W|s|J|Pa|kg|A|V)[^\]]*\]", text) or WITHOUT_UNITS.search(text)
