"""The polar model with a concentration of filaments that is carried by the flow and diffuses."""
