"""The synthetic microscope: what an instrument would have recorded of a run."""
