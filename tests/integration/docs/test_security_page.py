"""SECURITY.md is true sentence by sentence: each names the test that guards it, and no other is there."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
STRANGERS = "integration/test_strangers_files.py::test_no_file_leads_elsewhere_or_to_no_end"
LAWS = "unit/test_own_laws.py::"
GUARDS = {
    "No code runs.": "unit/case/test_yaml_text.py::test_what_is_refused",
    "YAML is read as plain data": "unit/case/test_yaml_text.py::test_what_is_refused",
    "Formulas of a study": "unit/case/test_formula.py::test_a_formula_reaches_nothing_but_numbers",
    "Nothing is unpickled.": "integration/docs/test_security_page.py::test_nothing_is_unpickled",
    "No process that cdem starts": "unit/case/test_reader_process.py::"
    "test_nothing_is_imported_from_the_current_folder",
    "Laws of users are code.": LAWS + "test_code_is_refused_in_one_line",
    "A case that names some": LAWS + "test_code_is_refused_in_one_line",
    "No settings of matplotlib": "integration/output/test_settings.py::"
    "test_settings_of_a_stranger_s_folder_are_not_read",
    "Only `cdem law build` compiles.": LAWS + "test_a_library_must_be_there",
    "The text that was read": LAWS + "test_a_library_beside_the_header_is_not_loaded",
    "A folder of libraries": LAWS + "test_a_folder_that_others_may_write_is_refused",
    "A header includes": LAWS + "test_a_header_includes_no_other_file",
    "Nothing is written outside": "integration/cli/test_written_places.py::"
    "test_a_case_writes_into_its_result_folder_only",
    "No key of a case": "integration/cli/test_written_places.py::"
    "test_a_case_writes_into_its_result_folder_only",
    "`--overwrite` removes only": "unit/run/test_written_files.py::"
    "test_a_result_folder_with_a_file_of_the_user_stays_as_it_is",
    "Nothing is written, renamed": "unit/run/test_links.py::test_no_run_goes_on_through_a_link",
    "Files lead to no other file": STRANGERS,
    "GDAL has only the drivers": "unit/terrain/test_gdal.py::test_other_drivers_are_gone",
    "A VRT names plain grids": STRANGERS,
    "A KML file that links": STRANGERS,
    "Materials and references": STRANGERS,
    "A GeoPackage holds": STRANGERS,
    "HDF5 files, frames": "unit/run/test_links.py::test_frames_that_lead_elsewhere_are_refused",
    "Meshes in several files": STRANGERS,
    "Time and memory of reading": "unit/case/test_input_file.py::"
    "test_a_small_file_does_not_take_gigabytes",
    "A file that takes more": "unit/case/test_reader_process.py::test_what_goes_wrong_is_one_message",
    "Time means processor time": "unit/case/test_input_file.py::"
    "test_processor_time_counts_not_that_of_a_clock_on_the_wall",
    "GDAL, HDF5, VTK and LAZ": "unit/case/test_reader_process.py::test_what_goes_wrong_is_one_message",
    "A local sweep has no ports.": "integration/study/test_sweep.py::"
    "test_a_sweep_that_is_killed_goes_on",
    "Its workers are connected": "integration/study/test_sweep.py::"
    "test_workers_import_nothing_from_the_current_folder",
    "Ranks of a launch exchange": "integration/test_mpi.py::test_every_call_between_processes",
    "Nothing that a rank gets": "integration/test_mpi.py::test_every_call_between_processes",
    "Reports show names as text.": "integration/output/test_report.py::"
    "test_names_of_a_case_are_text_in_its_report",
    "`report.html` runs": "integration/output/test_browser.py::"
    "test_a_report_moves_and_asks_for_nothing",
    "`cdem view` serves": "unit/output/test_view.py::test_the_page_is_sent_with_its_policy",
    "Its address holds": "unit/output/test_view.py::"
    "test_a_name_that_another_site_has_bent_to_this_machine_is_refused",
    "The browser gets": "unit/cli/test_result_commands.py::"
    "test_the_address_is_told_and_opened_where_there_is_a_screen",
    "Threads and the time": "unit/output/test_view.py::"
    "test_connections_that_stay_open_keep_few_threads_and_not_for_long",
}
"""How each sentence of "What holds" begins, and the test that would fail if it were not true."""


def sentences() -> list[str]:
    """Sentences of the list under "What holds"."""
    page = (ROOT / "SECURITY.md").read_text()
    held = page.partition("## What holds\n")[2].partition("\nA test guards")[0]
    text = " ".join(held.replace("**", "").split())
    return [one for one in re.split(r"(?<=\.)\s+(?:- )?|^- ", text) if one]


def test_each_sentence_has_a_test():
    told = sentences()
    assert len(told) > 30
    for sentence in told:
        assert sum(sentence.startswith(begin) for begin in GUARDS) == 1, sentence
    for begin, guard in GUARDS.items():
        assert any(sentence.startswith(begin) for sentence in told), begin
        file, _, name = guard.partition("::")
        assert f"def {name}(" in (ROOT / "tests" / file).read_text(), guard


def test_nothing_is_unpickled():
    for path in (ROOT / "src/cdem").rglob("*.py"):
        text = path.read_text()
        assert not re.search(r"\b(import (pickle|dill|shelve|marshal)|allow_pickle=True)", text), (
            path
        )
