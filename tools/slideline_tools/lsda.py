# SPDX-License-Identifier: MIT
"""Writer of LSDA files, the container of DYNA's binout: a tree of directories with named arrays."""
import pathlib
import struct

import numpy as np

CD, DATA, VARIABLE, BEGIN_TABLE, END_TABLE, TABLE_OFFSET = 2, 3, 4, 5, 6, 7
#: what numpy calls a type -> its number in the file
TYPES = {"i1": 1, "i4": 3, "i8": 4, "f4": 9, "f8": 10}
COMMAND = struct.Struct("<QB")        # length of the record, command
ENTRY = struct.Struct("<BQQ")         # type, offset of the record, number of values
#: sizes in bytes of lengths, offsets, commands and types; little endian; IEEE numbers
HEADER = bytes((8, 8, 8, 1, 1, 1, 0, 0))


class Writer:
    """Write arrays one after the other; the table of contents follows when it is closed.

        with Writer(path) as file:
            file.write("/glstat/d000001", "time", 0.0)
    """

    def __init__(self, path):
        """Make the file, replacing one of that name."""
        self._stream = open(pathlib.Path(path), "wb")
        self._stream.write(HEADER + COMMAND.pack(COMMAND.size + 8, TABLE_OFFSET))
        self._table_at = self._stream.tell()
        self._stream.write(struct.pack("<Q", 0))
        self._folder = None
        self._entries = {}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def write(self, folder, name, values):
        """Write one array (a number, a text or numbers) as `folder`/`name`.

        Integers become 4-byte, reals 8-byte numbers, texts bytes.
        """
        values = stored(values)
        self._change_to(folder)
        entry = (name, TYPES[values.dtype.str[1:]], self._stream.tell(), values.size)
        label = bytes((entry[1], len(name))) + name.encode("ascii")
        body = values.tobytes()
        self._stream.write(COMMAND.pack(COMMAND.size + len(label) + len(body), DATA) + label + body)
        self._entries.setdefault(folder, []).append(entry)

    def _change_to(self, folder):
        if folder != self._folder:
            self._stream.write(cd_record(folder))
            self._folder = folder

    def close(self):
        """Write the table of contents and close the file."""
        if self._stream.closed:
            return
        start = self._stream.tell()
        records = b"".join(cd_record(folder) + b"".join(map(variable_record, self._entries[folder]))
                           for folder in sorted(self._entries))
        end = COMMAND.pack(COMMAND.size + 8, END_TABLE) + struct.pack("<Q", 0)
        self._stream.write(COMMAND.pack(COMMAND.size + len(records) + len(end), BEGIN_TABLE)
                           + records + end)
        self._stream.seek(self._table_at)
        self._stream.write(struct.pack("<Q", start))
        self._stream.close()


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
