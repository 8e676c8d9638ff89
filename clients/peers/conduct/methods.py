"""Methods of libraries, called directly with their defaults. Each returns x, whether it claims success, its code and
its own count of calls (none: it has none). `limit` is the library's own limit of calls, or none.
Programs in R, Octave and C++ also take a list of inputs, which they run one after the other in one process."""
import ctypes
import ctypes.util
import dataclasses
import glob
import json
import pathlib
import subprocess
import sys
import typing

import numpy

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))
from peers import built


@dataclasses.dataclass
class Outcome:
    x: numpy.ndarray
    success: bool
    code: str
    own: typing.Optional[int]


@dataclasses.dataclass
class Method:
    name: str
    package: str
    run: typing.Callable  # (input, limit) -> Outcome
    takes: str  # "residuals" or "loss"
    differences: bool = False  # it takes its own, or needs no derivatives
    keeps_bounds: bool = False
    has_limit: bool = True  # of calls
    lost: dict = dataclasses.field(default_factory=dict)  # what was not run, or must not be: why

    def is_program(self):
        return self.package.split()[0] in ("Rscript", "octave-cli", "c++")


ALL = []


def add(*names, package, **more):
    def take(function):
        for name in names:
            run = lambda p, limit, last=name.split(" ")[-1]: function(p, limit, last)
            ALL.append(Method(name, package, run, **more))
        return function

    return take


# --- SciPy, lmfit, iminuit


@add("SciPy least_squares trf", "SciPy least_squares dogbox", package="scipy", takes="residuals", differences=True,
     keeps_bounds=True)
@add("SciPy least_squares lm", package="scipy", takes="residuals", differences=True)
def least_squares(p, limit, name):
    from scipy.optimize import least_squares

    bounds = {"bounds": p.bounds} if p.bounds else {}
    found = least_squares(p.residual, p.start, method=name, max_nfev=limit, **bounds)
    return Outcome(found.x, found.status > 0, f"status {found.status}", found.nfev)


@add("SciPy Nelder-Mead", "SciPy Powell", package="scipy", takes="loss", differences=True, keeps_bounds=True)
@add("SciPy COBYLA", package="scipy", takes="loss", differences=True)
@add("SciPy L-BFGS-B", "SciPy TNC", package="scipy", takes="loss", keeps_bounds=True)
@add("SciPy SLSQP", "SciPy trust-constr", package="scipy", takes="loss", keeps_bounds=True, has_limit=False)
@add("SciPy BFGS", "SciPy CG", package="scipy", takes="loss", has_limit=False)
def minimize(p, limit, name):
    from scipy.optimize import Bounds, minimize

    limits = {"Nelder-Mead": "maxfev", "Powell": "maxfev", "COBYLA": "maxiter", "L-BFGS-B": "maxfun", "TNC": "maxfun"}
    options = {limits[name]: limit} if limit and name in limits else {}
    bounds = {"bounds": Bounds(*p.bounds)} if p.bounds else {}
    slope = None if name in ("Nelder-Mead", "Powell", "COBYLA") else p.gradient
    found = minimize(p.value, p.start, jac=slope, method=name, options=options, **bounds)
    return Outcome(found.x, bool(found.success), f"status {found.status}", found.nfev)


@add("lmfit leastsq", "lmfit least_squares", package="lmfit", takes="residuals", differences=True, keeps_bounds=True)
def lmfit(p, limit, name):
    import lmfit

    start = lmfit.Parameters()
    for i, value in enumerate(p.start):
        low, high = (p.bounds[0][i], p.bounds[1][i]) if p.bounds else (-numpy.inf, numpy.inf)
        start.add(f"x{i}", value, min=low, max=high)
    of = lambda given: p.residual(numpy.array([each.value for each in given.values()]))
    found = lmfit.minimize(of, start, method=name, max_nfev=limit)
    return Outcome(numpy.array([each.value for each in found.params.values()]), bool(found.success), found.message,
                   found.nfev)


@add("iminuit MIGRAD", package="iminuit", takes="loss", differences=True, keeps_bounds=True)
def migrad(p, limit, _):
    import iminuit

    minuit = iminuit.Minuit(lambda x: 2 * p.value(x), p.start)
    if p.bounds:
        minuit.limits = list(zip(*p.bounds))
    minuit.migrad(ncall=limit)
    return Outcome(numpy.array(minuit.values), minuit.valid, "valid" if minuit.valid else "not valid", minuit.nfcn)


# --- PETSc

NOT_FOR_THREADS = {"threads": "not run: PETSc is for one thread"}


@add("TAO POUNDERS", package="petsc4py", takes="residuals", differences=True, keeps_bounds=True,
     lost=NOT_FOR_THREADS)
@add("TAO BRGN", package="petsc4py", takes="residuals", keeps_bounds=True, lost=NOT_FOR_THREADS)
@add("TAO LMVM", package="petsc4py", takes="loss", lost=NOT_FOR_THREADS)
@add("TAO BLMVM", "TAO BNCG", "TAO BQNLS", package="petsc4py", takes="loss", keeps_bounds=True,
     lost=NOT_FOR_THREADS)
def tao(p, limit, name):
    petsc()
    from petsc4py import PETSc

    vector = lambda values: PETSc.Vec().createWithArray(numpy.array(values, float), comm=PETSc.COMM_SELF)
    method, x = PETSc.TAO().create(PETSc.COMM_SELF), vector(p.start)
    method.setType(name.lower())
    if name in ("POUNDERS", "BRGN"):
        method.setResidual(lambda _, x, r: r.setArray(p.residual(x.getArray())), vector(numpy.zeros(p.m)))
    else:
        method.setObjective(lambda _, x: p.value(x.getArray()))
        method.setGradient(lambda _, x, g: g.setArray(p.gradient(x.getArray())), vector(p.start))
    if name == "BRGN":
        J = PETSc.Mat().createDense((p.m, p.n), comm=PETSc.COMM_SELF).setUp()
        fill = lambda J, rows: (J.setValues(range(p.m), range(p.n), numpy.ascontiguousarray(rows)), J.assemble())
        method.setJacobianResidual(lambda _, x, J, __: fill(J, p.jacobian(x.getArray())), J, J)
    if p.bounds:
        method.setVariableBounds(vector(p.bounds[0]), vector(p.bounds[1]))
    if limit:
        method.setMaximumFunctionEvaluations(limit)
    method.setFromOptions()
    method.solve(x)
    reason, own = method.getConvergedReason(), INT()
    library("petsc_real").TaoGetCurrentFunctionEvaluations(POINTER(method.handle), ctypes.byref(own))
    return Outcome(x.getArray().copy(), reason > 0, f"reason {reason}", own.value)


def petsc():
    sys.path += glob.glob("/usr/lib/petscdir/*/*-real*/lib/python3/dist-packages")  # of Debian
    import petsc4py

    petsc4py.init([""])


# --- libraries in C, by ctypes

DOUBLES = ctypes.POINTER(ctypes.c_double)
POINTER, INT, DOUBLE, SIZE = ctypes.c_void_p, ctypes.c_int, ctypes.c_double, ctypes.c_size_t


def library(name):
    return ctypes.CDLL(ctypes.util.find_library(name) or f"lib{name}.so")


def array_at(pointer, count):
    return numpy.ctypeslib.as_array(pointer, (count,))


def doubles(values):
    return numpy.array(values, float), lambda a: a.ctypes.data_as(DOUBLES)


class Carried:
    """An exception of a callback, which C cannot pass on."""

    def __init__(self, stop, worst):
        self.error, self.stop, self.worst = None, stop, worst

    def __call__(self, work):
        if self.error is None:
            try:
                return work()
            except BaseException as error:
                self.error = error
                self.stop()
        return self.worst




@add("NLopt LD_LBFGS", "NLopt LD_SLSQP", "NLopt LD_VAR2", "NLopt LD_TNEWTON_PRECOND_RESTART", "NLopt LD_MMA",
     package="nlopt", takes="loss", keeps_bounds=True)
@add("NLopt LN_NELDERMEAD", "NLopt LN_SBPLX", "NLopt LN_BOBYQA", "NLopt LN_COBYLA", package="nlopt", takes="loss",
     differences=True, keeps_bounds=True)
def nlopt(p, limit, name):
    lib = library("nlopt")
    lib.nlopt_create.restype = POINTER
    of_type = ctypes.CFUNCTYPE(DOUBLE, ctypes.c_uint, DOUBLES, DOUBLES, POINTER)
    opt = POINTER(lib.nlopt_create(lib.nlopt_algorithm_from_string(name.encode()), ctypes.c_uint(p.n)))
    carried = Carried(lambda: lib.nlopt_force_stop(opt), 0.0)

    def evaluate(n, x, slope):
        at = array_at(x, n).copy()
        if slope:
            array_at(slope, n)[:] = p.gradient(at)
        return p.value(at)

    callback = of_type(lambda n, x, slope, _: carried(lambda: evaluate(n, x, slope)))
    lib.nlopt_set_min_objective(opt, callback, None)
    if p.bounds:
        for side, values in zip((lib.nlopt_set_lower_bounds, lib.nlopt_set_upper_bounds), p.bounds):
            held, pointer = doubles(values)
            side(opt, pointer(held))
    lib.nlopt_set_xtol_rel(opt, DOUBLE(1e-8))  # it has no tolerance by default
    if limit:
        lib.nlopt_set_maxeval(opt, INT(limit))
    x, pointer = doubles(p.start)
    least = DOUBLE()
    code = lib.nlopt_optimize(opt, pointer(x), ctypes.byref(least))
    own = lib.nlopt_get_numevals(opt)
    lib.nlopt_destroy(opt)
    if carried.error:
        raise carried.error
    return Outcome(x, code in (1, 2, 3, 4), f"code {code}", own)


@add("cminpack lmdif", package="cminpack", takes="residuals", differences=True)
@add("cminpack lmder", package="cminpack", takes="residuals")
def cminpack(p, limit, name):
    lib, n, m = library("cminpack"), p.n, p.m
    by_differences = name == "lmdif"
    x, pointer = doubles(p.start)
    stopped = Carried(lambda: None, -1)
    rooms = {"r": m, "J": m * n, "diag": n, "qtf": n, "a": n, "b": n, "c": n, "d": m}
    rooms = {each: numpy.zeros(count) for each, count in rooms.items()}
    pivots, nfev, njev = (INT * n)(), INT(), INT()

    def evaluate(x, r, J, flag):
        at = array_at(x, n).copy()
        if J is not None and flag == 2:
            array_at(J, m * n)[:] = p.jacobian(at).T.ravel()
        else:
            array_at(r, m)[:] = p.residual(at)
        return 0

    if by_differences:
        kind = ctypes.CFUNCTYPE(INT, POINTER, INT, INT, DOUBLES, DOUBLES, INT)
        call = kind(lambda _, __, ___, x, r, flag: stopped(lambda: evaluate(x, r, None, flag)))
    else:
        kind = ctypes.CFUNCTYPE(INT, POINTER, INT, INT, DOUBLES, DOUBLES, DOUBLES, INT, INT)
        call = kind(lambda _, __, ___, x, r, J, ____, flag: stopped(lambda: evaluate(x, r, J, flag)))
    r, J, diag, qtf, *work = (pointer(each) for each in rooms.values())
    most = limit or 200 * (n + 1)
    tight = [DOUBLE(1e-8), DOUBLE(1e-8), DOUBLE(0)]
    if by_differences:
        code = lib.lmdif(call, None, m, n, pointer(x), r, *tight, most, DOUBLE(0), diag, 1, DOUBLE(100), 0,
                         ctypes.byref(nfev), J, m, pivots, qtf, *work)
    else:
        code = lib.lmder(call, None, m, n, pointer(x), r, J, m, *tight, most, diag, 1, DOUBLE(100), 0,
                         ctypes.byref(nfev), ctypes.byref(njev), pivots, qtf, *work)
    if stopped.error:
        raise stopped.error
    return Outcome(x, code in (1, 2, 3, 4), f"info {code}", nfev.value)


@add("liblbfgs", package="lbfgs", takes="loss", has_limit=False)
def lbfgs(p, _, __):
    lib = library("lbfgs")
    lib.lbfgs_malloc.restype = DOUBLES
    kind = ctypes.CFUNCTYPE(DOUBLE, POINTER, DOUBLES, DOUBLES, INT, DOUBLE)
    seen = ctypes.CFUNCTYPE(INT, POINTER, DOUBLES, DOUBLES, DOUBLE, DOUBLE, DOUBLE, DOUBLE, INT, INT, INT)
    stopped = Carried(lambda: None, 0.0)

    def evaluate(x, g):
        at = array_at(x, p.n).copy()
        array_at(g, p.n)[:] = p.gradient(at)
        return p.value(at)

    call = kind(lambda _, x, g, __, ___: stopped(lambda: evaluate(x, g)))
    stop = seen(lambda *_: int(stopped.error is not None))
    x = lib.lbfgs_malloc(p.n)
    array_at(x, p.n)[:] = p.start
    least = DOUBLE()
    code = lib.lbfgs(p.n, x, ctypes.byref(least), call, stop, None, None)
    if stopped.error:
        raise stopped.error
    return Outcome(array_at(x, p.n).copy(), code in (0, 2), f"code {code}", None)


@add("Ipopt", package="ipopt", takes="loss", keeps_bounds=True, has_limit=False)
def ipopt(p, _, __):
    lib, n = library("ipopt"), p.n
    lib.CreateIpoptProblem.restype = POINTER
    stopped = Carried(lambda: None, 0)

    def write(to, values):
        to[:] = values
        return 1

    f = ctypes.CFUNCTYPE(INT, INT, DOUBLES, INT, DOUBLES, POINTER)(
        lambda _, x, __, out, ___: stopped(lambda: write(array_at(out, 1), p.value(array_at(x, n).copy()))))
    g = ctypes.CFUNCTYPE(INT, INT, DOUBLES, INT, DOUBLES, POINTER)(
        lambda _, x, __, out, ___: stopped(lambda: write(array_at(out, n), p.gradient(array_at(x, n).copy()))))
    none = ctypes.CFUNCTYPE(INT)(lambda: 1)
    far = numpy.full(n, 2e19)  # infinite, to Ipopt
    lower, pointer = doubles(p.bounds[0] if p.bounds else -far)
    upper, _ = doubles(p.bounds[1] if p.bounds else far)
    problem = POINTER(lib.CreateIpoptProblem(n, pointer(lower), pointer(upper), 0, None, None, 0, 0, 0, f, none, g,
                                             none, none))
    lib.AddIpoptStrOption(problem, b"hessian_approximation", b"limited-memory")
    lib.AddIpoptIntOption(problem, b"print_level", 0)
    x, _ = doubles(p.start)
    code = lib.IpoptSolve(problem, pointer(x), None, None, None, None, None, None)
    lib.FreeIpoptProblem(problem)
    if stopped.error:
        raise stopped.error
    return Outcome(x, code in (0, 1), f"status {code}", None)


# --- R, Octave and C++: the library and its callback are there, the values here


@add("R nls.lm", package="Rscript minpack.lm", takes="residuals", differences=True, keeps_bounds=True)
@add("R nloptr", package="Rscript nloptr", takes="loss", keeps_bounds=True)
@add("R bobyqa", package="Rscript minqa", takes="loss", differences=True, keeps_bounds=True)
@add("R nlminb", package="Rscript stats", takes="loss", keeps_bounds=True)
@add("R optim-BFGS", package="Rscript stats", takes="loss", has_limit=False)
@add("R optim-L-BFGS-B", package="Rscript stats", takes="loss", keeps_bounds=True, has_limit=False)
@add("Octave leasqr", package="octave-cli optim", takes="residuals", differences=True, keeps_bounds=True, has_limit=False)
@add("Octave fminunc", package="octave-cli optim", takes="loss")
def of_a_script(p, limit, name):
    is_octave = name in ("leasqr", "fminunc")
    program = ["octave-cli", "-qf", HERE / "methods.m"] if is_octave else ["Rscript", HERE / "methods.R"]
    return of_program([*program, name], p, limit)


@add("dlib find_min_bobyqa", package="c++ dlib", takes="loss", differences=True, keeps_bounds=True,
     lost={"missing": "not run: it needs two unknowns"})
@add("dlib find_min_global", package="c++ dlib", takes="loss", differences=True, keeps_bounds=True,
     lost={"QD": "not run: it takes no start"})
@add("dlib find_min_lbfgs", package="c++ dlib", takes="loss", has_limit=False)
@add("ALGLIB minlm", package="c++ alglib", takes="residuals", differences=True, keeps_bounds=True, has_limit=False)
@add("ALGLIB minlbfgs", package="c++ alglib", takes="loss", has_limit=False)
@add("ALGLIB minbleic", package="c++ alglib", takes="loss", keeps_bounds=True, has_limit=False)
def of_cpp(p, limit, name):
    package = "dlib" if name.startswith("find_min") else "alglib"
    return of_program([built(HERE / "methods.cpp").resolve(), package, name.replace("find_min_", "")], p, limit)


@add("GSL multifit_nlinear lm", "GSL multifit_nlinear lmaccel", "GSL multifit_nlinear dogleg", package="c++ gsl",
     takes="residuals", differences=True, has_limit=False)
@add("GSL multimin bfgs2", package="c++ gsl", takes="loss", has_limit=False)
@add("Ceres", package="c++ ceres", takes="residuals", differences=True, keeps_bounds=True, has_limit=False)
@add("pagmo de", "pagmo cmaes", package="c++ pagmo", takes="loss", differences=True, keeps_bounds=True, has_limit=False)
def of_more_cpp(p, limit, name):
    package = {"Ceres": "ceres", "de": "pagmo", "cmaes": "pagmo"}.get(name, "gsl")
    return of_program([built(HERE / "more_methods.cpp").resolve(), package, name], p, limit)


def of_program(command, given, limit):
    """The outcome of an input; of a list of them, whose values are alike, a list."""
    numbers = lambda values: " ".join(map(repr, map(float, values)))
    answers = {"value": lambda p, x: [p.value(x)], "residual": lambda p, x: p.residual(x),
               "gradient": lambda p, x: p.gradient(x)}
    problems, outcomes = given if isinstance(given, list) else [given], []
    p = problems[0]
    bounds = p.bounds or (numpy.full(p.n, -numpy.inf), numpy.full(p.n, numpy.inf))
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as child:
        try:
            print(p.n, p.m, limit or 0, int(p.bounds is not None), len(problems),
                  numbers([*p.start, *bounds[0], *bounds[1]]), file=child.stdin, flush=True)
            for line in child.stdout:
                mark, *words = line.split() or [""]
                if mark == "done":
                    success, own, code, *x = words
                    outcomes.append(Outcome(numpy.array(x, float), success == "1", code,
                                            None if own == "none" else int(own)))
                    if len(outcomes) == len(problems):
                        return outcomes if isinstance(given, list) else outcomes[0]
                    print(file=child.stdin, flush=True)
                elif mark in answers:
                    answer = answers[mark](problems[len(outcomes)], numpy.array(words, float))
                    print(numbers(answer), file=child.stdin, flush=True)
                else:
                    print(line, end="")
            raise RuntimeError("the library raised an error")
        finally:
            child.kill()
