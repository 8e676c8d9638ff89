#!/usr/bin/env bash
# Apache Commons Math 3.6.1: bounds, starts and limits of one run hold in the next that gives none.
#
# Guess before the run: optimize() uses the data that it is given; without bounds there are none,
# without MaxIter no limit, and without a start there is an error. A limit throws in all optimizers.
# Seen: BOBYQAOptimizer, called again without SimpleBounds, ends at the 0.25 of the box of the first
# run, where the least is 0, and needs no start, either; SimplexOptimizer fails at the five iterations
# of an earlier call. CMAESOptimizer has none of the errors: at MaxEval 50 it returns 3.51 as if it
# had converged, and counts 51. Make an optimizer for each run, and compare getEvaluations() with the
# limit.
. "$(dirname "$0")/packages.sh"
debian libcommons-math3-java=3.6.1-3
command -v javac >/dev/null || { echo "this script needs javac"; exit 2; }
cat >"$work/Run.java" <<'J'
import org.apache.commons.math3.optim.*;
import org.apache.commons.math3.optim.nonlinear.scalar.*;
import org.apache.commons.math3.optim.nonlinear.scalar.noderiv.*;
import org.apache.commons.math3.random.MersenneTwister;

public class Run {
  static int calls;
  static double best;
  static final ObjectiveFunction VALLEY = new ObjectiveFunction(x -> {
    double v = 100 * Math.pow(x[1] - x[0] * x[0], 2) + Math.pow(1 - x[0], 2);
    calls++;
    best = Math.min(best, v);
    return v;
  });

  static void run(String name, MultivariateOptimizer method, OptimizationData... data) {
    OptimizationData[] all = new OptimizationData[data.length + 2];
    System.arraycopy(data, 0, all, 2, data.length);
    all[0] = VALLEY;
    all[1] = GoalType.MINIMIZE;
    calls = 0;
    best = 1e300;
    String end;
    try {
      end = String.format("%.2f", method.optimize(all).getValue());
    } catch (RuntimeException e) {
      end = e.getClass().getSimpleName();
    }
    System.out.printf("%s: %s, best seen %.2f, %d calls, counted %d%n", name, end, best, calls, method.getEvaluations());
  }

  public static void main(String[] arguments) {
    InitialGuess start = new InitialGuess(new double[] {-1.2, 1});
    SimpleBounds box = new SimpleBounds(new double[] {-2, -2}, new double[] {0.5, 2});
    MaxEval many = new MaxEval(1000);
    BOBYQAOptimizer bobyqa = new BOBYQAOptimizer(5);
    run("BOBYQA with bounds", bobyqa, many, start, box);
    run("again, without", bobyqa, many, start);
    run("and without a start", bobyqa, many);
    run("BOBYQA, limit 20", new BOBYQAOptimizer(5), new MaxEval(20), start, box);
    SimplexOptimizer simplex = new SimplexOptimizer(1e-10, 1e-10);
    run("simplex, 5 iterations", simplex, many, start, new NelderMeadSimplex(2), new MaxIter(5));
    run("again, without", simplex, many, start, new NelderMeadSimplex(2));
    run("a new one", new SimplexOptimizer(1e-10, 1e-10), many, start, new NelderMeadSimplex(2));
    run("CMA-ES, limit 50", new CMAESOptimizer(30, 0, true, 0, 0, new MersenneTwister(1), false, null),
        new MaxEval(50), start, box, new CMAESOptimizer.Sigma(new double[] {0.3, 0.3}),
        new CMAESOptimizer.PopulationSize(10));
  }
}
J
export CLASSPATH=$root/usr/share/java/commons-math3-3.6.1.jar:$work
javac -d "$work" "$work/Run.java"
expect 'BOBYQA with bounds: 0.25, best seen 0.25, 109 calls, counted 109
again, without: 0.25, best seen 0.25, 109 calls, counted 109
and without a start: 0.25, best seen 0.25, 109 calls, counted 109
BOBYQA, limit 20: TooManyEvaluationsException, best seen 4.08, 20 calls, counted 21
simplex, 5 iterations: TooManyIterationsException, best seen 2.88, 15 calls, counted 15
again, without: TooManyIterationsException, best seen 2.88, 15 calls, counted 15
a new one: 0.00, best seen 0.00, 146 calls, counted 146
CMA-ES, limit 50: 3.51, best seen 3.51, 50 calls, counted 51' java Run
