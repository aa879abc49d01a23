"""The terms of the filament equation, each in a sentence for a person who has never heard of the model."""

CAPTIONS = {
    "advection": "The moving cytoplasm carries filaments along.",
    "shear": "Where neighbouring layers slide past each other, filaments are turned, as straws in a stream.",
    "bundling": "Neighbouring filaments stick together and agree on a direction: they bundle into cables.",
    "flow_alignment": "The flow combs filaments into its own direction, and motors on them drive it onward.",
    "repulsion": "The wound wall of the cell resists filaments that run around it, so that cables run along.",
    "diffusion": "Directions spread to neighbours, which smooths out differences.",
    "rotational_diffusion": "Random turning destroys order, all the time and everywhere.",
}
"""By the name of the term."""
