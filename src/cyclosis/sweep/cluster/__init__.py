"""How a sweep is computed: workers on this machine or on a running cluster, their queue and progress."""
