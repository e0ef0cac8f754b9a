"""What can go wrong, by who has to mend it. Every message is the program's own sentence."""


class ItpmsError(Exception):
    """Any failure of this package."""


class LogError(ItpmsError, ValueError):
    """A drive log (a file or a table) that cannot be used: says where, what was found, what was expected."""


class VehicleError(ItpmsError, ValueError):
    """A vehicle file that cannot be used."""


class ScenarioError(ItpmsError, ValueError):
    """A scenario that cannot be driven."""


class SettingError(ItpmsError, ValueError):
    """Arguments that are refused, or that do not go together."""


class OutputError(ItpmsError, OSError):
    """A file that cannot be written."""
