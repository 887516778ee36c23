# SPDX-License-Identifier: GPL-3.0-or-later
"""What each command does, once its arguments are read; each returns its exit code.

Blender is imported by the commands that need it, so that the others and all help texts come at once.
"""

from __future__ import annotations

import json
from argparse import Namespace
from dataclasses import asdict
from pathlib import Path

from ...lib.comparison.compare import CompareOptions
from ...lib.effects.plan import Plan, make_plan
from ...lib.errors import Cancelled, EtalonError
from ...lib.files.atomic import replace_file
from ...lib.film.exr import write_film
from ...lib.film.film import Film
from ...lib.progress import Progress
from ...lib.report.words import sentences, unexplained
from ...lib.sampling.streams import COUNTED
from ...lib.scene import archive
from ...lib.scene.scene import Scene
from ...lib.wavefront.options import Options
from ...lib.wavefront.render import ReferenceRenderer
from .console import bar, ended_by_interrupt, interruptible, quiet


def compare(arguments: Namespace) -> int:
    """Open the scene, compare, print the verdict; the exit code is the verdict's."""
    if arguments.scene is not None and arguments.scene.endswith(".npz"):
        raise EtalonError(
            f"{arguments.scene}: Cycles cannot render a saved scene; give the .blend, or use etalon render"
        )
    verdict = CompareOptions(
        tolerance=arguments.tolerance,
        confidence=arguments.confidence,
        time=arguments.time,
        samples=arguments.samples,
        replicates=arguments.replicates,
        seed=arguments.seed,
    )
    with ended_by_interrupt():
        import bpy

        from .. import job
        from .opening import open_target
    choices = job.Choices(verdict, _reference_options(arguments), arguments.partial)
    name = open_target(arguments.scene, arguments.frame, arguments.camera, arguments.assignments)
    folder = arguments.out or Path("etalon-out") / name
    with interruptible() as interrupted, bar(name) as report, quiet():
        comparison = job.compare_here(
            bpy.context.scene, choices, folder, arguments.repeat, Progress(report, interrupted)
        )
    print(f"{comparison.scene}: {comparison.verdict.outcome.value}")
    for sentence in sentences(comparison):
        print(f"  {sentence}")
    print(f"report: {folder / 'report.html'}")
    if unexplained(comparison):
        print(f"what shows it: {folder / job.MINIMAL}")
    return comparison.verdict.outcome.exit_code


def render(arguments: Namespace) -> int:
    """Render the reference alone and write it as EXR; Ctrl-C writes the replicates that are done."""
    options = _reference_options(arguments)
    scene = _exported(arguments)
    film = Film.empty(scene.camera.height, scene.camera.width, arguments.samples)
    with replace_file(arguments.out) as path, interruptible() as interrupted, bar(scene.name) as report:
        renderer = ReferenceRenderer(scene, options)
        progress, count = Progress(report, interrupted), arguments.replicates
        for replicate in range(count):
            part = progress.within(replicate / count, (replicate + 1) / count)
            try:
                film.add(renderer.render(COUNTED.number(replicate), arguments.samples, part))
            except Cancelled:
                break
        if not film.moments.n:
            raise EtalonError(f"{scene.name}: interrupted before the first replicate was done; nothing was written")
        write_film(path, film)
    print(f"{arguments.out}: {film.moments.n} replicates of {arguments.samples} samples, {film.seconds:.1f} s")
    return 0


def scenes(arguments: Namespace) -> int:
    """List the reference scenes, or save one as a .blend."""
    with ended_by_interrupt():
        from ...reference_scenes import SCENES, save
    if arguments.save is None:
        width = max(map(len, SCENES))
        for name, module in SCENES.items():
            print(f"{name:{width}}  {module.__doc__.splitlines()[0]}")
        return 0
    name, path = arguments.save
    with quiet():
        save(name, Path(path))
    print(f"{name} saved as {path}")
    return 0


def plan(arguments: Namespace) -> int:
    """Print which effects the scene calls for, each with the fact that decided it."""
    scene = _exported(arguments)
    decided = make_plan(scene)
    if arguments.save is not None:
        archive.save(scene, arguments.save)
    if arguments.json:
        print(json.dumps({"scene": scene.name, **asdict(decided)}, indent=2))
    else:
        print(plan_text(scene, decided))
    return 0


def plan_text(scene: Scene, decided: Plan) -> str:
    """The plan as two lists for a terminal."""
    width = max(len(decision.effect) for decision in decided.decisions)
    lines = [f"{scene.name}: {scene.mesh.triangle_count} triangles, {len(scene.lights)} lights"]
    for heading, needed in (("needed", True), ("not needed", False)):
        lines += ["", heading]
        lines += [f"  {d.effect:{width}}  {d.fact}" for d in decided.decisions if d.needed is needed]
    return "\n".join(lines)


def batch(arguments: Namespace) -> int:
    """Run a PLAN.toml."""
    from ...lib.batch.run import read_plan, run

    planned = read_plan(arguments.plan)
    code = run(planned)
    print(f"grid: {planned.out / 'batch.html'}")
    return code


def cost(arguments: Namespace) -> int:
    """Measure error against time."""
    from .cost import run

    return run(arguments)


def audit(arguments: Namespace) -> int:
    """Measure what each Cycles setting costs."""
    with ended_by_interrupt():
        from .audit import run

    return run(arguments)


def stability(arguments: Namespace) -> int:
    """Run the stability atlas, one line a case, and write its report."""
    from ...lib.stability import atlas

    cases = []
    for case in atlas.equations(arguments.points):
        print(atlas.line(case), flush=True)
        cases.append(case)
    if not arguments.no_scenes:
        with ended_by_interrupt():
            from .edge import edge_cases
        for case in edge_cases():
            print(atlas.line(case), flush=True)
            cases.append(case)
    atlas.write(cases, arguments.out)
    broken = [case.name for case in cases if not case.passed]
    print(f"{len(cases) - len(broken)} of {len(cases)} held; report: {arguments.out / 'stability.html'}")
    return 1 if broken else 0


def _reference_options(arguments: Namespace) -> Options:
    return Options(
        strategy=arguments.strategy,
        direct=arguments.direct,
        masking=arguments.masking,
        departures=frozenset(arguments.depart),
        sampler=arguments.sampler,
        russian_roulette=arguments.russian_roulette,
        seed=arguments.seed,
        threads=arguments.threads,
    )


def _exported(arguments: Namespace) -> Scene:
    """The scene that the arguments name, from a saved .npz or through Blender."""
    if arguments.scene is not None and arguments.scene.endswith(".npz"):
        return archive.load(Path(arguments.scene))
    with ended_by_interrupt():
        import bpy

        from .. import job
        from .opening import open_target
    open_target(arguments.scene, arguments.frame, arguments.camera, arguments.assignments)
    with quiet():
        return job.export(bpy.context.scene)


COMMANDS = {
    "compare": compare,
    "render": render,
    "scenes": scenes,
    "plan": plan,
    "cost": cost,
    "audit": audit,
    "batch": batch,
    "stability": stability,
}
