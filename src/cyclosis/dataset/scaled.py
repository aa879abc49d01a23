"""The physical units of a run's dataset, which are those stored with it or given later."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from ..model.errors import InputError
from ..model.units import of_table, stored, table_of

if TYPE_CHECKING:
    import xarray

    from ..model.scales import Scales


def with_scales(
    dataset: xarray.Dataset, scales: Scales | None = None, radius_um: Any = None, speed_um_s: Any = None
) -> xarray.Dataset:
    """Return a run's dataset that is shown in the units of a cell; its numbers stay dimensionless.

    A radius or a speed alone replaces that of the dataset. Figures, exports and summaries of what is returned
    are in micrometres, seconds and minutes. Raises `InputError` for only one of the two if the dataset has
    no scales, and for values that are not positive.

    Example:
        >>> import cyclosis as cy
        >>> from cyclosis.dataset import run_table, with_scales
        >>> params, grid = cy.Parameters(), cy.CylinderGrid(16, 16)
        >>> data = cy.simulate(params, grid, cy.initial.stripes(grid), t_end=2.0).to_dataset()
        >>> table = run_table(with_scales(data, cy.Scales(500.0, 75.0)))
        >>> table["time"], table["time_s"].round(2)
        (array([0., 1., 2.]), array([ 0.  ,  6.67, 13.33]))
    """
    if not hasattr(dataset, "assign_attrs"):
        raise InputError("dataset", type(dataset).__name__, "an xarray.Dataset", "use the dataset of a run")
    given = {} if scales is None else table_of(scales)
    given |= {k: v for k, v in (("radius_um", radius_um), ("speed_um_s", speed_um_s)) if v is not None}
    chosen = of_table(stored(dataset) | given)
    if chosen is None:
        return dataset
    return dataset.assign_attrs(scales=json.dumps(table_of(chosen), sort_keys=True))
