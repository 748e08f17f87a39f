"""A fault, and what a user is to be told of it."""

import dataclasses
import typing


@dataclasses.dataclass
class Fault:
    """`make` alters a log. Where the map is not right, a warning or the refusal must match `says`, a
    regular expression; where `must_say`, also where it is right."""

    name: str
    make: typing.Callable
    says: str = "nothing is to be said"
    must_say: bool = False


class FaultList(list):
    """Faults of one module: a decorator adds one."""

    def add(self, name, says="nothing is to be said", must_say=False):
        def keep(make):
            self.append(Fault(name, make, says, must_say))
            return make

        return keep

    def each(self, name, values, says="nothing is to be said", must_say=False):
        """One fault per value, which `make` gets as its second argument; names hold it at {}."""

        def keep(make):
            for value in values:
                self.append(Fault(name.format(value), lambda log, value=value: make(log, value), says, must_say))
            return make

        return keep
