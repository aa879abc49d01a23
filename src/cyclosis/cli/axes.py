"""An axis as an argument of the command line: NAME=START:STOP:COUNT[:log]."""

from __future__ import annotations

from ..model.errors import InputError


def axis(field: str, text: str) -> tuple[str, list[float]]:
    """Return the name and the values of an axis given as NAME=START:STOP:COUNT[:log]."""
    from ..sweep.plan.axes import values

    name, _, rest = text.partition("=")
    parts = rest.split(":")
    try:
        spacing = "linear" if len(parts) == 3 else {"log": "log"}[parts[3]]
        start, stop, count = float(parts[0]), float(parts[1]), int(parts[2])
        if not (2 <= count <= 10_000 and start < stop and len(parts) < 5 and (start > 0 or spacing != "log")):
            raise ValueError
    except (ValueError, IndexError, KeyError):
        rule = "NAME=START:STOP:COUNT or NAME=START:STOP:COUNT:log, with START < STOP and COUNT from 2"
        raise InputError(field, text, rule, "write it as alpha_u=0.05:1:20") from None
    table = {"start": start, "stop": stop, "count": count, "spacing": spacing}
    return name.strip(), list(values(table))
