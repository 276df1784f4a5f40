"""Small maps that tests of the terrain share: a slope near 10.2 E 46.9 N, in any projection and file."""

import numpy as np

UTM32 = "EPSG:32632"
WEST, SOUTH = 591_000.0, 5_193_000.0  # of the map, in UTM32 [m]
RING = np.array([[300, 300], [700, 300], [700, 700], [300, 700]]) + [WEST, SOUTH]


def height(xy, west=WEST, south=SOUTH):
    """A slope of 30 deg to the east with gentle waves [m]."""
    x, y = (np.asarray(xy, float) - [west, south]).T
    return 2000 - x * np.tan(np.radians(30)) + 10 * np.sin(x / 150) * np.cos(y / 200)


def moved(xy, source, target):
    """Points from one projection to another."""
    import pyproj

    to = pyproj.Transformer.from_crs(source, target, always_xy=True)
    return np.column_stack(to.transform(*np.asarray(xy, float).T))


def write_raster(path, crs=UTM32, cell=10.0, label=True, change=None, **options):
    """A GeoTIFF of `height`, 1 km wide and a cell beyond its ends, in a projection.

    `cell` is in metres, or about that much in degrees; `change` is applied to the heights.
    """
    import rasterio

    corners = np.array([[WEST, SOUTH], [WEST + 1000, SOUTH + 1000]])
    degrees = crs == "EPSG:4326"
    ring = np.array([[0, 0], [1000, 0], [1000, 1000], [0, 1000]]) + [WEST, SOUTH]
    there = moved(ring, UTM32, crs) if crs != UTM32 else corners
    low, high = there.min(axis=0), there.max(axis=0)
    step = np.array([cell / 76_000, cell / 111_200]) if degrees else np.full(2, cell)
    low, high = low - 2 * step, high + 2 * step
    columns, rows = np.ceil((high - low) / step).astype(int)
    x = low[0] + step[0] * (np.arange(columns) + 0.5)
    y = low[1] + step[1] * (np.arange(rows)[::-1] + 0.5)
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    z = height(moved(points, crs, UTM32) if crs != UTM32 else points).reshape(rows, columns)
    z = change(z) if change else z
    place = rasterio.transform.from_origin(low[0], low[1] + step[1] * rows, *step)
    head = {"width": columns, "height": rows, "count": 1, "dtype": "float64", "transform": place}
    head |= {"crs": crs if label is True else label} if label else {}
    with rasterio.open(path, "w", driver=options.pop("driver", "GTiff"), **head, **options) as file:
        file.write(z, 1)
    return path


def write_shape(path, ring=RING, crs=UTM32, source=UTM32, line=False, label=True, **fields):
    """A polygon, or closed line, in a file of any kind; `ring` is in the projection `source`."""
    import pyogrio
    import shapely

    drivers = {
        ".gpkg": "GPKG", ".shp": "ESRI Shapefile", ".kml": "KML", ".fgb": "FlatGeobuf",
        ".dxf": "DXF", ".geojson": "GeoJSON",
    }  # fmt: skip
    points = moved(ring, source, crs) if crs != source else np.asarray(ring, float)
    shape = shapely.LinearRing(points) if line else shapely.Polygon(points)
    if line:
        shape = shapely.LineString(shape.coords)
    kind = "LineString" if line else "Polygon"
    columns = [np.array([value], object) for value in fields.values()]
    pyogrio.raw.write(
        path, np.array([shapely.to_wkb(shape)]), columns, list(fields), geometry_type=kind,
        crs=crs if label else None, driver=drivers[path.suffix],
    )  # fmt: skip
    return path
