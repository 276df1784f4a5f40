"""A case from a stranger writes into its result folder and nowhere else."""

from pathlib import Path

from shared.cases import CUBE


def tree(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_a_case_writes_into_its_result_folder_only(run_cli, tmp_path, monkeypatch, no_report):
    for name in ("there/deep", "here"):
        (tmp_path / name).mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "here")
    case = tmp_path / "there/deep/case.yaml"
    names = ["..", "...", "~", "C", "a;b", "$HOME", "-rf", "CON"]
    histories = ", ".join(
        f"{{name: '{name}', group: cube, quantities: [velocity]}}" for name in names
    )
    case.write_text(CUBE.replace("title: ", "title: ../../") + f"histories: [{histories}]\n")
    before = tree(tmp_path)
    assert run_cli("run", str(case), "-o", "results", "--quiet")[0] == 0
    assert run_cli("plot", "results")[0] == 0
    after = tree(tmp_path)
    new = after.keys() - before.keys()
    assert new and all(name.startswith("here/results/") for name in new)
    assert {name: after[name] for name in before} == before
    for name in ("a/b", "../b", "..\\\\b"):
        case.write_text(
            CUBE + f"histories: [{{name: '{name}', group: cube, quantities: [velocity]}}]"
        )
        status, _, err = run_cli("run", str(case), "-o", "results", "--overwrite")
        assert status == 1 and "names files, so it cannot contain the character" in err
