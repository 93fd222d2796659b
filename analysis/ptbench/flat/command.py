"""`python3 -m ptbench flat`: rows of result files as one CSV or Parquet table, for R, Julia, DuckDB, spreadsheets."""

import csv
from collections.abc import Sequence
from pathlib import Path

from ptbench.errors import bad_value
from ptbench.io.files import check_output_file, write_whole
from ptbench.report.sources import find_sources
from ptbench.tidy.columns import CATEGORY, FLAG, INTEGER, NUMBER
from ptbench.tidy.descriptions import meaning_of
from ptbench.tidy.rows import Rows, load_files, table_of

PYARROW = "pyarrow==22.0.0"  # requirement of the extra `parquet` in pyproject.toml
_LARGEST_SIGNED = (1 << 63) - 1


def flat(results: Sequence[Path], out: Path, table: str) -> int:
    """Writes the rows of one table, and prints their number; raises InputError. No `table`: as by `table_of`."""
    write = _writer(out)
    check_output_file(out)
    rows = table_of(load_files(find_sources(results).paths), table)
    write_whole(out, lambda temporary: write(rows, temporary))
    print(f"{out}: {len(rows.rows)} rows, {len(rows.types)} columns")
    return 0


def _writer(out: Path):
    if out.suffix == ".csv":
        return write_csv
    if out.suffix != ".parquet":
        raise bad_value(out, "--out", f'the ending "{out.suffix}"', ".csv or .parquet")
    try:
        import pyarrow  # noqa: F401 - whether it is there, before anything is read
    except ImportError as error:
        allowed = f"a .csv, or Parquet where there is pyarrow (pip install {PYARROW})"
        raise bad_value(out, "--out", "no Python package pyarrow", allowed) from error
    return write_parquet


def write_csv(rows: Rows, path: Path) -> None:
    """Writes rows as CSV in UTF-8 with a header; a missing value is empty, and numbers survive a round trip."""
    with open(path, "w", encoding="utf-8", errors="backslashreplace", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(rows.types)
        for row in rows.rows:
            writer.writerow([_text(row.get(name), kind) for name, kind in rows.types.items()])


def _text(value: object, kind: str) -> str:
    if value is None:
        return ""
    if kind == FLAG:
        return "true" if value else "false"
    return repr(float(value)) if kind == NUMBER else str(value)


def write_parquet(rows: Rows, path: Path) -> None:
    """Writes rows as Parquet: strings as dictionaries, missing values as null, a description with each column."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    fields, arrays = [], []
    for name, kind in rows.types.items():
        values = [row.get(name) for row in rows.rows]
        array = pa.array(values, _arrow_type(values, kind))
        arrays.append(array.dictionary_encode() if kind == CATEGORY else array)
        fields.append(pa.field(name, arrays[-1].type, metadata={"description": meaning_of(name)}))
    pq.write_table(pa.Table.from_arrays(arrays, schema=pa.schema(fields)), path)


def _arrow_type(values: Sequence, kind: str):
    import pyarrow as pa

    if kind == NUMBER:
        return pa.float64()
    if kind == INTEGER:  # a signed column does not hold all 64-bit seeds
        return pa.uint64() if max((v for v in values if v is not None), default=0) > _LARGEST_SIGNED else pa.int64()
    return pa.bool_() if kind == FLAG else pa.string()
