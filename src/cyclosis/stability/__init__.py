"""Steady states of the model, found without simulating."""

from . import profile as profile
from .profile import Profile as Profile
from .profile import cyclosis as cyclosis
from .profile import stripes as stripes
