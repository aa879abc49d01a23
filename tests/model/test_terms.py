from cyclosis.model.definitions import PARAMETERS
from cyclosis.model.equation import TERM_NAMES
from cyclosis.model.filaments import FUNCTIONS, TERMS
from cyclosis.model.moment import Values


def test_the_values_are_the_parameters_and_the_packed_form_of_the_repulsion():
    assert Values._fields == (*(item.name for item in PARAMETERS), "kappa_mirror")


def test_each_term_of_the_equation_has_its_function():
    assert tuple(FUNCTIONS) == TERM_NAMES
    assert [term.function.__name__ for term in TERMS] == list(TERM_NAMES)
