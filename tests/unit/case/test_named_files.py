"""Files that a case names are found wherever they stand."""

from cdem.case.named_files import files_of


def test_all_files_of_a_case_are_found():
    discs, body = {"file": "discs.csv"}, {"group": "rock", "file": "rock.obj"}
    data = {
        "own_laws": ["clay.hpp", 3],
        "model": {"mesh": "a.msh", "blocks": [body], "joints": [{"name": "d", "discs": discs}, 3]},
        "water": {
            "fields": [{"level": 3}, {"surface": "dry.asc"}, {"table": "p.csv"}],
            "reservoir": {"history": {"file": "tide.csv"}},
        },
        "loads": {
            "tractions": [{"history": [[0, 1]]}, {"history": {"file": "quay.csv"}}],
            "surfaces": [{"history": {"file": "blast.csv"}}, {"history": {"files": "no.csv"}}],
        },
        "stages": [
            {"name": "dry"},
            {"name": "wet", "set": {"water.fields.1.surface": "wet.asc", "water.fields.1.lift": 1}},
            {"name": "on", "set": {"loads.surfaces.0.history": {"file": "late.csv"}}},
        ],
    }
    assert [holder[key] for holder, key in files_of(data)] == [
        "clay.hpp", "a.msh", "rock.obj", "discs.csv", "dry.asc", "p.csv",
        "tide.csv", "quay.csv", "blast.csv", "late.csv", "wet.asc",
    ]  # fmt: skip


def test_what_is_no_case_names_no_file():
    for wrong in (3, [3], {"fields": 3}, [{"set": 3}]):
        assert files_of({name: wrong for name in ("model", "own_laws", "water", "stages")}) == []
