import numpy as np
import pytest

from oracles.gallery import load


def test_the_coefficient_comes_back_and_its_error_has_a_least(tmp_path, capsys):
    example = load("block_and_bed")
    found = example.main(tmp_path / "x.png")
    for h, extractions in found.items():
        # the drop was made with this coefficient
        assert [one.coefficient for one in extractions] == pytest.approx([h] * len(extractions), rel=1e-6)
        for one in extractions:
            parts = np.array(list(one.budget.values()))
            assert one.standard_error == pytest.approx(np.sqrt((parts**2).sum()))
        # the better the contact, the less the drop says of it, and ever less with time
        assert (np.diff([one.sensitivity for one in extractions]) < 0).all()
    relative = [min(one.standard_error for one in found[h]) / h for h in example.COEFFICIENTS]
    assert relative[0] < relative[1] < relative[2]
    assert capsys.readouterr().out.count("best read after") == 3
