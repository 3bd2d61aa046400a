"""What a long command is doing is told on standard error, in a log as well as in a terminal."""

import re

from hydrolek_drake.cli.output import progress


def test_a_log_has_a_line_for_each_step_with_its_time(capsys) -> None:
    with progress("starting") as tell:
        tell("fitting [1, 2] ...")
        tell("writing the report, " + 40 * "which is long, ")
    said = capsys.readouterr()
    assert said.out == ""
    first, second = said.err.splitlines()
    assert re.fullmatch(r" +\d+\.\d s  fitting \[1, 2\] \.\.\.", first)
    assert second.rstrip().endswith("which is long,")


def test_what_fails_before_its_first_step_adds_no_line_to_the_refusal(capsys) -> None:
    with progress("starting"):
        pass
    assert capsys.readouterr().err == ""
