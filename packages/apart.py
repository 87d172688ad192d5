"""Shared libraries under names of their own, so that a process may hold others of the same names: the files' (SONAME), and those of
all that they define, since the loader gives a function to whoever asks for its name first, whatever file it is in.
"""

import struct
import sys

import make_zip  # addon's

LOAD, DYNAMIC, NOTE = 1, 2, 4
NULL, NEEDED, HASH, STRTAB, STRSZ, SONAME, RPATH, RUNPATH, GNU_HASH = 0, 1, 4, 5, 10, 14, 15, 29, 0x6FFFFEF5
SECTION_HASH, SECTION_VERNEED, SECTION_DYNSYM, SECTION_GNU_HASH = 5, 0x6FFFFFFE, 11, 0x6FFFFFF6
PAGE = 4096
SUFFIX = ".pelagic"  # demanglers take it for a clone of the function


def own_file_name(name):
    """libtbb.so.12 → libtbb-pelagic.so.12"""
    return name.replace(".so", "-pelagic.so", 1)


class Library:
    """An ELF library of x86-64, to be changed in memory: strings that it names are appended, none is moved."""

    def __init__(self, name, data):
        self.name = name
        if data[:5] != b"\x7fELF\x02" or struct.unpack_from("<H", data, 18)[0] != 62:
            self._refuse("is no ELF library of x86-64")
        self.data = bytearray(data)
        segments, sections = struct.unpack_from("<QQ", data, 32)
        size, count, section_size, section_count = struct.unpack_from("<HHHH", data, 54)
        self.segments = [segments + i * size for i in range(count)]
        self.sections = [sections + i * section_size for i in range(section_count)]
        self.symbols = self._section(SECTION_DYNSYM)
        _, _, _, _, self.symbols_at, symbols_size, link = struct.unpack_from("<IIQQQQI", data, self.symbols)
        self.symbol_count = symbols_size // 24
        self.strings_section = self.sections[link]
        at, size = struct.unpack_from("<QQ", data, self.strings_section + 24)
        self.strings = bytearray(data[at:at + size])

    def _refuse(self, why):
        sys.exit(f"{self.name} {why}: it can't get names of its own")

    def _section(self, kind):
        return next((s for s in self.sections if struct.unpack_from("<I", self.data, s + 4)[0] == kind), None)

    def string(self, at):
        return bytes(self.strings[at:self.strings.index(0, at)]).decode()

    def _add(self, text):
        self.strings += text.encode() + b"\0"
        return len(self.strings) - len(text.encode()) - 1

    def _symbols(self):
        """Place, name, whether it is defined here."""
        for i in range(1, self.symbol_count):
            at = self.symbols_at + 24 * i
            name, _, _, section = struct.unpack_from("<IBBH", self.data, at)
            yield at, self.string(name), section != 0

    def defined(self):
        return {name for _, name, is_defined in self._symbols() if is_defined}

    def _dynamic(self):
        """Places of the entries, with those that are spare at the end."""
        segment = next(s for s in self.segments if struct.unpack_from("<I", self.data, s)[0] == DYNAMIC)
        at, = struct.unpack_from("<Q", self.data, segment + 8)
        size, = struct.unpack_from("<Q", self.data, segment + 32)
        return range(at, at + size, 16)

    def _entry(self, tag):
        return next((e for e in self._dynamic() if struct.unpack_from("<q", self.data, e)[0] == tag), None)

    def rename(self, files, symbols, rpath):
        """files: those that have new names; symbols: those that get SUFFIX. rpath: where it looks for what it needs."""
        old = {name: self._add(own_file_name(name)) for name in files}
        for entry in self._dynamic():
            tag, value = struct.unpack_from("<qQ", self.data, entry)
            if tag in (NEEDED, SONAME) and self.string(value) in old:
                struct.pack_into("<Q", self.data, entry + 8, old[self.string(value)])
        needs = self._section(SECTION_VERNEED)
        if needs is not None:
            at, = struct.unpack_from("<Q", self.data, needs + 24)
            while True:
                _, _, file, _, following = struct.unpack_from("<HHIII", self.data, at)
                if self.string(file) in old:
                    struct.pack_into("<I", self.data, at + 4, old[self.string(file)])
                if not following:
                    break
                at += following
        changes_own = False
        for at, name, is_defined in self._symbols():
            if name in symbols:
                struct.pack_into("<I", self.data, at, self._add(name + SUFFIX))
                changes_own |= is_defined
        if self._entry(RUNPATH) and self._entry(RPATH):
            self._refuse("has both an RPATH and a RUNPATH")
        entry = self._entry(RUNPATH) or self._entry(RPATH) or self._entry(NULL)
        if entry == self._dynamic()[-1]:
            self._refuse("has no room for an RPATH")
        struct.pack_into("<qQ", self.data, entry, RPATH, self._add(rpath))
        self._write(changes_own)

    def _write(self, changes_own):
        """The strings, and a table to look symbols up by their new names, in a segment of their own at the end."""
        loads = [s for s in self.segments if struct.unpack_from("<I", self.data, s)[0] == LOAD]
        end = max(sum(struct.unpack_from("<Q", self.data, s + 16) + struct.unpack_from("<Q", self.data, s + 40)) for s in loads)
        address = -(-end // PAGE) * PAGE
        table = self._hash_table() if changes_own else b""
        self.data += bytes(-len(self.data) % PAGE)
        offset = len(self.data)
        self.data += table + self.strings
        # A note's entry in the list of segments, which can't grow, becomes this one's: they are for debuggers.
        note = next((s for s in self.segments if s > loads[-1] and struct.unpack_from("<I", self.data, s)[0] == NOTE), None)
        if note is None:
            self._refuse("has no note (PT_NOTE) after what is loaded")
        size = len(table) + len(self.strings)
        struct.pack_into("<IIQQQQQQ", self.data, note, LOAD, 4, offset, address, address, size, size, PAGE)
        struct.pack_into("<Q", self.data, self._entry(STRTAB) + 8, address + len(table))
        struct.pack_into("<Q", self.data, self._entry(STRSZ) + 8, len(self.strings))
        struct.pack_into("<QQQ", self.data, self.strings_section + 16, address + len(table), offset + len(table), len(self.strings))
        if table:
            if self._entry(HASH) or not self._entry(GNU_HASH):
                self._refuse("has another table of its symbols than DT_GNU_HASH alone")
            # Of the older kind, whose order isn't the symbols' own: they stay where they are.
            struct.pack_into("<qQ", self.data, self._entry(GNU_HASH), HASH, address)
            section = self._section(SECTION_GNU_HASH)
            struct.pack_into("<I", self.data, section + 4, SECTION_HASH)
            struct.pack_into("<QQQ", self.data, section + 16, address, offset, len(table))

    def _hash_table(self):
        buckets, chains = [0] * self.symbol_count, [0] * self.symbol_count
        for i, (_, name, _) in enumerate(self._symbols(), 1):
            bucket = make_zip.elf_hash(name.encode()) % len(buckets)
            buckets[bucket], chains[i] = i, buckets[bucket]
        return struct.pack(f"<II{2 * self.symbol_count}I", len(buckets), len(chains), *buckets, *chains)


def apart(libraries, user, rpath):
    """libraries: SONAME → bytes, each of which may need others of them; user: the bytes of the one that needs them.
    The same under their new names, and the user, which looks for them in rpath."""
    read = {name: Library(name, data) for name, data in libraries.items()}
    symbols = set().union(*(library.defined() for library in read.values()))
    for library in read.values():
        library.rename(libraries, symbols, "$ORIGIN")  # a linker follows each one's own
    user = Library("the library that needs them", user)
    user.rename(libraries, symbols, rpath)
    return {own_file_name(name): bytes(library.data) for name, library in read.items()}, bytes(user.data)
