"""A real kernel: a run shows a line, and its results their page."""

import pytest

nbclient = pytest.importorskip("nbclient", reason="needs the extra 'docs'")

CELLS = [
    """import cdem
case = {
    "model": {"blocks": [{"group": "cube", "box": {"size": [1, 1, 1]}}]},
    "materials": {"rock": {"density": 2700, "young_modulus": "1 GPa", "poisson_ratio": 0.25}},
    "groups": {"cube": {"material": "rock"}},
    "interfaces": {"default": {"friction_angle": 30}},
    "stages": [{"name": "fall", "mode": "dynamic", "duration": 0.05}],
}
simulation = cdem.Simulation(case, threads=1, output="fall.results")
simulation.run()""",
    'cdem.open("fall.results")',
    'import sys; print("ipywidgets" in sys.modules)',
]


def test_a_notebook_shows_a_run_and_its_page(tmp_path):
    from nbformat import v4

    book = v4.new_notebook(cells=[v4.new_code_cell(text) for text in CELLS])
    client = nbclient.NotebookClient(book, timeout=60, resources={"metadata": {"path": tmp_path}})
    client.execute()
    run, page, widgets = (cell.outputs for cell in book.cells)
    line, status = run  # redrawn in place: one output
    assert line.output_type == "display_data" and status.data["text/plain"] == "'finished'"
    assert line.data["text/plain"].startswith("fall: t 0.05")
    assert "<iframe srcdoc=" in page[0].data["text/html"]
    assert len(page[0].data["text/html"]) < 3_000_000
    assert widgets[0].text == "False\n"
