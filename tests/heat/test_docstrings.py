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
HELPERS = {"flow_correlations.warn_outside_fit", "systems.check_correlation", "heat_exchanger.bracketed_root"}
"""No models: they check, warn or solve."""

WITHOUT_UNITS = re.compile(r"over|ratio|number|factor|fraction|share|porosity|emissivity|exponent", re.IGNORECASE)
"""Words of quantities that have none."""

SOURCE = re.compile(r"\b(1[6-9]|20)\d\d\b|\beq\. ?\d|\bTable \d|et al\.|section \d")


def test_there_are_many():
    assert len(FUNCTIONS) > 180


@pytest.mark.parametrize("name", sorted(set(FUNCTIONS) - HELPERS))
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
    assert "Raises\n------" in text or "refuses" in text
    # a source, its own or its module's
    assert SOURCE.search(text) or SOURCE.search(inspect.getdoc(inspect.getmodule(function)) or "")
    # a quantity with a unit somewhere, or nothing but numbers without one
    assert (
        "float or array" not in text
        or re.search(r"\[[^\]]*(m|K|W|s|J|Pa|kg|A|V)[^\]]*\]", text)
        or WITHOUT_UNITS.search(text)
    )
