"""Units as OPC UA names them: by the codes of UNECE recommendation 20."""

from __future__ import annotations

from typing import Final

from asyncua import ua

_CODES: Final = {
    'rad': ('C81', 'radian'),
    'm': ('MTR', 'metre'),
    'rad/s': ('2A', 'radian per second'),
    'm/s': ('MTS', 'metre per second'),
    'kg': ('KGM', 'kilogram'),
    '°C': ('CEL', 'degree Celsius'),
}


def engineering_unit(text: str) -> ua.EUInformation:
    """The unit with a symbol, one of 'rad', 'm', 'rad/s', 'm/s', 'kg' and '°C'."""
    code, name = _CODES[text]
    return ua.EUInformation(
        NamespaceUri='http://www.opcfoundation.org/UA/units/un/cefact',
        UnitId=int.from_bytes(code.encode(), 'big'),
        DisplayName=ua.LocalizedText(text),
        Description=ua.LocalizedText(name),
    )
