"""Files of strangers: no request goes out, no other file is read, and each ends in one line, in time."""

import json
import os
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest
from shared import strangers

from cdem.errors import CdemError
from cdem.mesh.mesh_files import read_mesh
from cdem.outcrop.cloud_files import read_outcrop
from cdem.terrain.facet_files import read_facets
from cdem.terrain.features import read_features
from cdem.terrain.rasters import read_raster

pytest.importorskip("pyogrio", reason="needs the extra 'terrain'")
SECRET = "TOPSECRET"


@pytest.fixture(scope="module")
def listener():
    """Address of a server on this machine, and the requests that it has seen."""
    seen = []

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            seen.append((self.command, self.path))
            self.send_error(404)

        do_HEAD = do_POST = do_GET

        def log_message(self, *_):
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}", seen
        server.shutdown()


@pytest.mark.parametrize(
    ("write", "read", "count", "taken"),
    [
        # of 7 descriptions under 6 endings each description and each ending, and all the others
        (strangers.write_vectors, read_features, 54, [*range(0, 42, 5), *range(42, 54)]),
        pytest.param(strangers.write_vectors, read_features, 54, range(54), marks=pytest.mark.slow),
        pytest.param(
            strangers.write_more_vectors, read_features, 48, range(48), marks=pytest.mark.slow
        ),
        (strangers.write_rasters, read_raster, 33, range(33)),
        (strangers.write_meshes, read_mesh, 5, range(5)),
        (strangers.write_clouds, read_outcrop, 6, range(6)),
        (strangers.write_facets, read_facets, 10, range(10)),
    ],
    ids=["vectors", "all vectors", "more vectors", "rasters", "meshes", "clouds", "facets"],
)
def test_no_file_leads_elsewhere_or_to_no_end(
    tmp_path, monkeypatch, listener, write, read, count, taken
):
    url, seen = listener
    monkeypatch.setenv("AWS_S3_ENDPOINT", url.removeprefix("http://"))
    folder = tmp_path / "case"
    folder.mkdir()
    secret = tmp_path / "secret.geojson"
    point = {"type": "Point", "coordinates": [0, 0]}
    feature = {"type": "Feature", "properties": {"s": SECRET}, "geometry": point}
    secret.write_text(json.dumps(feature))
    paths = write(folder, url, secret)
    assert len(paths) == count
    before = sorted(os.listdir(folder))
    for path in (paths[k] for k in taken):
        began = time.process_time()
        children = os.times()
        with pytest.raises(CdemError) as caught:
            read(path)
        said = str(caught.value)
        assert str(path) in said and "\n" not in said and SECRET not in said, path.name
        after = os.times()
        taken = time.process_time() - began + after.children_user - children.children_user
        assert taken < 5, path.name
    assert seen == []
    assert (
        secret.exists() and sorted(os.listdir(folder)) == before
    )  # nothing is written beside a file
