"""Add the arm to a checkout of example-robot-data: files, loaders, names and tests.

python scripts/robots/add_to_example_robot_data.py ../example-robot-data
"""

from __future__ import annotations

import argparse
from pathlib import Path

from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model._support.writing import atomic_write_all
from alpha5_model.description.assets import mesh_assets
from alpha5_model.description.srdf import srdf
from alpha5_model.description.urdf import Variant, urdf

HERE = Path(__file__).parent
FOLDER = "alpha5_description"
MESHES = f"package://example-robot-data/robots/{FOLDER}/meshes/"
PACKAGE = Path("python", "example_robot_data")
#: File -> text before which a line goes, and that line.
LINES = {
    PACKAGE / "robots_loader.py": (
        ("from .human import", "from .alpha5 import Alpha5JawsLoader, Alpha5Loader\n"),
        (
            '    "b1": ',
            '    "alpha5": Alpha5Loader,\n    "alpha5_jaws": Alpha5JawsLoader,\n',
        ),
    ),
    Path("unittest", "test_load.py"): (
        (
            "    def test_anymal",
            '    def test_alpha5(self):\n        self.check("alpha5", 4, 4)\n\n'
            "    def test_alpha5_jaws(self):\n"
            '        self.check("alpha5_jaws", 7, 7)\n\n',
        ),
    ),
}


def patch(checkout: Path) -> dict[Path, bytes]:
    """Path -> content of the files to write.

    A checkout that has the arm gets its files anew, its lines once.

    Raises:
        SystemExit: No checkout, one of a version before 5, or one in which a line has
            no place.
    """
    _refuse_old(checkout)
    loaders = (HERE / "example_robot_data_loaders.py").read_bytes()
    files = {checkout / PACKAGE / "alpha5.py": loaders}
    for name, lines in LINES.items():
        path = checkout / name
        if not path.is_file():
            raise SystemExit(
                f"{path}: no such file; expected a checkout of example-robot-data"
            )
        text = path.read_text("utf-8")
        for before, line in lines:
            if before not in text:
                raise SystemExit(
                    f"{path}: no {before.strip()!r}, "
                    f"before which to write {line.strip()!r}"
                )
            if line not in text:
                text = text.replace(before, line + before, 1)
        files[path] = text.encode()
    folder = checkout / "robots" / FOLDER
    return files | {folder / path: data for path, data in robot_files().items()}


def robot_files() -> dict[str, bytes]:
    """The arm's folder under ``robots/``: path in it -> content."""
    files = {
        "README.md": (HERE / "example_robot_data_readme.md").read_bytes(),
        "LICENSE": Path(REPOSITORY_PATH, "LICENSE").read_bytes(),
    }
    for name, content in mesh_assets(".obj", ".mtl").items():
        files[f"meshes/{name}"] = content
    for gripper, name in (("locked", "alpha5"), ("jaws", "alpha5_jaws")):
        variant = Variant(gripper=gripper, mesh_prefix=MESHES)
        files[f"urdf/{name}.urdf"] = urdf(variant).encode()
        files[f"srdf/{name}.srdf"] = srdf(gripper).encode()
    return files


def _refuse_old(checkout: Path) -> None:
    """Version 4 has every loader in one file; 5 has one in each, beside `utils`.

    Raises:
        SystemExit: A checkout of such a version.
    """
    loaders_file = checkout / PACKAGE / "robots_loader.py"
    utilities = checkout / PACKAGE / "utils.py"
    if loaders_file.is_file() and not utilities.is_file():
        raise SystemExit(
            f"{utilities}: no such file; this checkout of example-robot-data is older "
            "than version 5, which is expected"
        )


def main() -> None:
    """Write the files and say which."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkout", type=Path, help="Folder of the checkout.")
    files = patch(parser.parse_args().checkout)
    atomic_write_all(files)
    for path in files:
        print(f"wrote {path}")


if __name__ == "__main__":
    main()
