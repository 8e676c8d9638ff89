"""An optimizer in any language, by lines of text on its standard input and output.

    isoline run --problem rosenbrock --optimizer 'process[command="python3 -m lines Rscript mine.R"]'

The program prints a line that begins with the word isoline, and reads one line of numbers as the answer:

    isoline optimizer least_squares needs=jacobian name=mine    n m, then n numbers of each: x0, lower, upper
    isoline residual 1.5 -2                                        r, m numbers

docs/serving-problems.md has all requests. Other lines that the program prints are its own output.
"""

import subprocess
import sys

import isoline

FLAGS = ("least_squares", "reports", "keeps_bounds")
TEXTS = ("name", "note", "source")


def words_of(numbers):
    return " ".join(map(repr, map(float, numbers)))


def declared(words):
    """The arguments of isoline.optimizer from the first line."""
    given = {}
    for word in words:
        name, equals, value = word.partition("=")
        if name in FLAGS and not equals:
            given[name] = True
        elif name == "needs" and value:
            given[name] = value.split(",")
        elif name == "failed" and value:
            given[name] = float(value)
        elif name in TEXTS and value:
            given[name] = value.replace("_", " ")
        else:
            raise isoline.Refused(f"'isoline optimizer' takes {', '.join(FLAGS)}, needs=, failed=, "
                                  f"{'=, '.join(TEXTS)}=; got {word!r}")
    return isoline.optimizer(**given)


def jacobian_row_by_row(p, x):
    return [each for row in p.jacobian(x) for each in row]


ANSWERS = {
    "value": lambda p, x: [p.value(x)],
    "gradient": lambda p, x: p.gradient(x),
    "residual": lambda p, x: p.residual(x),
    "jacobian": jacobian_row_by_row,
    "jvp": lambda p, both: p.jvp(both[: p.n], both[p.n :]),
    "vjp": lambda p, both: p.vjp(both[: p.n], both[p.n :]),
    "hvp": lambda p, both: p.hvp(both[: p.n], both[p.n :]),
    "report": lambda p, x: p.report(x) or [],
    "finish": lambda p, x: p.finish(x, p.message) or [],
}


def answer(p, request, words):
    if request == "claim":
        p.message = " ".join(words)
        return []
    if request not in ANSWERS:
        raise isoline.Refused(f"the program sent 'isoline {request}'; the requests are {', '.join(ANSWERS)} and claim")
    try:
        x = [float(word) for word in words]
    except ValueError as error:
        raise isoline.Refused(f"the program sent 'isoline {request}' with {error}") from None
    return ANSWERS[request](p, x)


def serve(program):
    p = None
    for line in program.stdout:
        mark, *words = line.split() or [""]
        if mark != "isoline" or not words:
            print(line, end="", flush=True)
        elif p is None:
            if words[0] != "optimizer":
                raise isoline.Refused(f"the first request must be 'isoline optimizer', got 'isoline {words[0]}'")
            p = declared(words[1:])
            p.message = ""
            print(p.n, p.residuals, words_of([*p.x0, *p.lower, *p.upper]), file=program.stdin, flush=True)
        else:
            print(words_of(answer(p, words[0], words[1:])), file=program.stdin, flush=True)
            if words[0] == "finish":
                return
    raise isoline.Refused(f"the program ended with code {program.wait()} before 'isoline finish'")


if __name__ == "__main__":
    if not sys.argv[1:]:
        sys.exit("usage: python3 -m lines PROGRAM ARGUMENTS")
    with subprocess.Popen(sys.argv[1:], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as program:
        try:
            serve(program)
        except (isoline.Refused, BrokenPipeError) as error:
            sys.exit(f"lines.py: {error}")
        finally:  # Isoline has ended the run, the program is wrong, or it has no more to do
            program.kill()
