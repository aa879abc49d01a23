"""What values look like: the colours of P_z, and how a notebook shows the nouns of the model."""
