"""Made-up sweeps with the layout of `open_sweep`, whose outcomes follow what is known of the model."""

import json

import numpy as np
import xarray

import cyclosis as cy

FIGURE5 = {"alpha_p": np.linspace(0.025, 1, 20), "alpha_u": np.linspace(0.025, 1, 20)}
PARAMETERS = {"epsilon": 0.1, "d_s": 0.025, "d_r": 0.025, "kappa": 0.5, "mu": 0.05}
CODE = {name: k for k, name in enumerate(cy.REGIMES)}
D, U, C, M = (CODE[name] for name in ("disordered", "unidirectional", "cyclosis", "multistripe"))
OUTCOMES = ("certified", "completed", "underresolved", "diverged")


def sweep(axes=None, seeds=50, configuration=None, **fixed):
    """Return the dataset of a sweep over `axes`, by name, with the parameters in `fixed` elsewhere.

    Disorder where alpha_p <= d_r. Elsewhere the outcome is cyclosis where m1/|k0| exceeds a ratio that falls
    as the flow aligns more, as in 80 runs of the model at five points; beyond a line, always.
    """
    axes = FIGURE5 if axes is None else axes
    names = (*axes, "seed")
    rng = np.random.default_rng(7)
    shape = (*(len(values) for values in axes.values()), seeds)
    at = {"alpha_p": 1.0, "alpha_u": 0.5, "filaments_per_square": 1000.0} | PARAMETERS | fixed
    for place, (name, values) in enumerate(axes.items()):
        at[name] = np.reshape(values, [-1 if k == place else 1 for k in range(len(shape))])
    noise = np.sqrt(0.5 / np.asarray(at["filaments_per_square"])) / 48
    k0 = np.broadcast_to(noise * rng.normal(size=seeds), shape)
    m1 = np.broadcast_to(noise * rng.rayleigh(np.sqrt(2), size=seeds), shape)
    a = np.broadcast_to(at["alpha_p"] - np.asarray(at["d_r"]), shape)
    growing = np.maximum(a, 1e-3)
    flow = np.asarray(at["alpha_u"]) * np.sqrt(at["alpha_p"])
    needed = 2.6 - 35 * np.minimum(flow, 0.1) - 6 / (1 + np.exp(-(np.minimum(flow, 0.1) - 0.052) / 0.002))
    lead = np.log(m1 / np.abs(k0)) - needed + 0.3 * rng.normal(size=shape)
    regime = np.where(lead > 0, CODE["cyclosis"], CODE["unidirectional"])
    weak = np.broadcast_to(flow, shape) < 0.06
    regime[(rng.random(shape) < 0.01) & (a > 0.6) & weak & (lead > 0)] = CODE["multistripe"]
    regime[a <= 1e-12] = CODE["disordered"]
    t_order = np.log(0.3 / np.hypot(k0, m1)) / growing * (1 + 0.2 * rng.random(shape)) + 3.0
    t_order[regime == CODE["disordered"]] = np.nan
    attrs = {"flag_values": np.arange(len(cy.REGIMES), dtype=np.int8), "flag_meanings": " ".join(cy.REGIMES)}
    data = {
        "regime": (names, regime.astype(np.int8), attrs | {"_FillValue": np.int8(-1)}),
        "status": (
            names,
            np.zeros(shape, dtype=np.int8),
            {"flag_values": np.arange(4, dtype=np.int8), "flag_meanings": " ".join(OUTCOMES)},
        ),
        "t_order": (names, t_order),
        "t_final": (names, 2 * np.nan_to_num(t_order, nan=150.0)),
        "initial_k0": (names, k0.copy()),
        "initial_m1": (names, m1.copy()),
    }
    tables = {"parameters": PARAMETERS | fixed, "run": {"finish": "certified"}}
    attributes = {"configuration": json.dumps(tables if configuration is None else configuration)}
    return xarray.Dataset(data, {**axes, "seed": np.arange(seeds)}, attributes)


def with_regimes(dataset, codes):
    """The same sweep with other regimes, broadcast over its points and seeds."""
    regime = dataset["regime"]
    return dataset.assign(regime=(regime.dims, np.broadcast_to(codes, regime.shape).copy(), regime.attrs))


def texts(figure):
    found = [text.get_text() for text in figure.texts]
    for ax in figure.axes:
        found += [text.get_text() for text in ax.texts]
        found += [ax.get_title(loc) for loc in ("left", "right")] + [ax.get_xlabel(), ax.get_ylabel()]
        if ax.get_legend():
            found += [text.get_text() for text in ax.get_legend().get_texts()]
    return [text for text in found if text]


def colours(ax, place=0):
    """The numbers behind the cells of axes, (ny, nx) as drawn."""
    return ax.collections[place].get_array()
