# SPDX-License-Identifier: MIT
"""Writer of LSDA files, the container of DYNA's binout: a tree of directories with named arrays."""
import struct

import numpy as np

CD, DATA, VARIABLE, BEGIN_TABLE, END_TABLE, TABLE_OFFSET = 2, 3, 4, 5, 6, 7
#: what numpy calls a type -> its number in the file
TYPES = {"i1": 1, "i4": 3, "i8": 4, "f4": 9, "f8": 10}
COMMAND = struct.Struct("<QB")        # length of the record, command
ENTRY = struct.Struct("<BQQ")         # type, offset of the record, number of values
#: sizes in bytes of lengths, offsets, commands and types; little endian; IEEE numbers
HEADER = bytes((8, 8, 8, 1, 1, 1, 0, 0))


def write(path, arrays):
    """Write (folder, name, values) one after the other, then the table of contents.

    Values are a number, a text or numbers: integers become 4-byte, reals 8-byte numbers, texts bytes.
    """
    entries, here = {}, None
    with open(path, "wb") as stream:
        stream.write(HEADER + COMMAND.pack(COMMAND.size + 8, TABLE_OFFSET))
        table_at = stream.tell()
        stream.write(struct.pack("<Q", 0))
        for folder, name, values in arrays:
            values = stored(values)
            if folder != here:
                stream.write(cd_record(folder))
                here = folder
            kind = TYPES[values.dtype.str[1:]]
            entries.setdefault(folder, []).append((name, kind, stream.tell(), values.size))
            body = bytes((kind, len(name))) + name.encode("ascii") + values.tobytes()
            stream.write(COMMAND.pack(COMMAND.size + len(body), DATA) + body)
        start = stream.tell()
        records = b"".join(cd_record(folder) + b"".join(map(variable_record, entries[folder])) for folder in sorted(entries))
        end = COMMAND.pack(COMMAND.size + 8, END_TABLE) + struct.pack("<Q", 0)
        stream.write(COMMAND.pack(COMMAND.size + len(records) + len(end), BEGIN_TABLE) + records + end)
        stream.seek(table_at)
        stream.write(struct.pack("<Q", start))


def stored(values):
    """The array as it is stored: little endian, of one of the types of the file."""
    if isinstance(values, str):
        return np.frombuffer(values.encode("latin-1", "replace"), dtype="<i1")
    values = np.atleast_1d(np.asarray(values))
    return np.ascontiguousarray(values, dtype="<i4" if values.dtype.kind in "iub" else "<f8")


def cd_record(folder):
    """A change of directory."""
    return COMMAND.pack(COMMAND.size + len(folder), CD) + folder.encode("ascii")


def variable_record(entry):
    """A line of the table of contents."""
    name, *rest = entry
    return (COMMAND.pack(COMMAND.size + len(name) + ENTRY.size, VARIABLE) + name.encode("ascii")
            + ENTRY.pack(*rest))
