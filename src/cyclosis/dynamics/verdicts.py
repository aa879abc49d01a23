"""How a run ended, in one sentence that claims no more than was found, and what to do."""

from __future__ import annotations

from .advance import CALM
from .course import Course
from .settings import Settings
from .steppers import METHODS
from .trajectory import Status
from .watch import remedy


def message(status: Status, t: float, how: Settings, course: Course, done: int, sign: str) -> str:
    """Return the sentence for a run that ended at time t, or whose first `sign` of a coarse grid was then.

    `done` is the number of events of its protocol that were done.
    """
    if status is Status.COMPLETED:
        return f"Completed: reached t = {t:g}."
    if status is Status.STEADY:
        return (
            f"Steady: for a time of {CALM:g}, up to t = {t:g}, the relative rate of change stayed below "
            f"{how.steady_rate:g} and did not grow; whether the state is stable was not examined."
        )
    if status is Status.INTERRUPTED:
        return f"Interrupted at t = {t:g}: what was saved until then is kept; resume to continue."
    if status is Status.UNDERRESOLVED:
        cure = remedy(course.problem, sign) or f"{_finer(course, t)}, or dealias"
        return f"Underresolved from t = {t:g}: {sign}; {cure}."
    adaptive = METHODS[how.stepper].adaptive
    cure = _finer(course, t) if adaptive else "use a smaller dt or the adaptive stepper"
    return (
        f"Diverged after t = {t:g}: |P| would pass {course.bound(done):g} or no step is small enough; "
        f"the last good state is kept; {cure}, or lower epsilon."
    )


def _finer(course: Course, t: float) -> str:
    problem = course.problem
    return problem.model.finer(course.schedule.params_at(t), problem.grid)
