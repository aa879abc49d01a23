"""The terms of the filament equation, each in a sentence for a person who has never heard of the model."""

CAPTIONS = {
    "advection": "The streaming fluid carries filaments along, as far as they are free to go.",
    "shear": "Where fluid slides past fluid it turns the filaments between, as it turns straws in a brook.",
    "bundling": "Neighbouring filaments stick together and point the same way, so that cables form.",
    "flow_alignment": "Filaments turn to point the way the fluid flows, and their motors then drive it on.",
    "repulsion": "Filaments avoid one direction, around the cell, and so come to lie along it.",
    "diffusion": "Filaments wander, which smooths out differences between one place and the next.",
    "rotational_diffusion": "Filaments turn at random, which undoes order always and everywhere.",
}
"""By the name of the term."""
