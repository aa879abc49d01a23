"""Where stripes exist and are stable: thresholds, limits, and unequal stripes."""
