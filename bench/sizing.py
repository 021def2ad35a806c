"""How long sizing takes: roofs of 600 to 20,000 members and the façade under four winds.

python bench/sizing.py [--most MEMBERS] [--out FOLDER]. Each is sized cold, then warm after a
control point has moved by 5 cm, as while a slider is dragged. Times in s; they hold for the machine
that the JSON names, with nothing else running.
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

from _shared import OUT, save, table
from heliform.engines.core.scene import Scene
from heliform.engines.structure import Facade, Live, Loading, Net, Roof, Structure
from heliform.engines.structure.surface import Shift

MOVED = Net(p11=Shift(z=0.05))
ROOFS = {600: 1.5, 1250: 1.0, 5000: 0.5, 20_000: 0.245}
WIND = Loading(area_load=0.0, wind=2500.0)


def main() -> None:
    asked = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    asked.add_argument("--most", type=int, default=20_000, help="members of the largest roof")
    asked.add_argument("--out", type=Path, default=OUT)
    given = asked.parse_args()
    records = {
        f"roof, {count:,}": Structure(roof=Roof(spacing=spacing))
        for count, spacing in ROOFS.items()
        if count <= given.most
    }
    records |= {
        f"façade, {modules} modules": Structure(
            form="facade", facade=Facade(modules=modules), loading=WIND
        )
        for modules in (12, 24)
    }
    Live().size(replace(records["roof, 600"], roof=Roof(spacing=4.0)), Scene())  # imports
    rows = [measured(name, record) for name, record in records.items()]
    head = list(rows[0])
    table(head, [[row[key] for key in head] for row in rows], "Sizing")
    save("sizing", {"rows": rows}, given.out)


def measured(name: str, record: Structure) -> dict:
    """One structure sized cold and warm."""
    live = Live()
    began = time.perf_counter()
    cold = live.size(record, Scene())
    middle = time.perf_counter()
    warm = live.size(replace(record, net=MOVED), Scene())
    ended = time.perf_counter()
    figures, after = (
        {key: figure["value"] for key, figure in result.figures().items()}
        for result in (cold, warm)
    )
    return {
        "structure": name,
        "members": len(cold.rows),
        "combinations": len(cold.meta["combinations"]),
        "cold (s)": middle - began,
        "rounds": int(figures["rounds"]),
        "converged": bool(figures["converged"]),
        "held": int(figures["held"]),
        "mass (t)": figures["mass"] / 1e3,
        "failing": int(figures["failing"]),
        "warm (s)": ended - middle,
        "warm rounds": int(after["rounds"]),
        "warm mass (t)": after["mass"] / 1e3,
    }


if __name__ == "__main__":
    main()
