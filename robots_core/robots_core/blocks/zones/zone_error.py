"""ZoneError, without what detects it."""

from robots_core.errors import PlanningError


class ZoneError(PlanningError):
    """A motion crosses the border of a zone that nothing opens."""

    code = 'R304'
    remedy = 'Stay inside or outside of the zone, or set the input that opens it (`docs/how_to/zones.md`).'
