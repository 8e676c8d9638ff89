"""The launcher at the top of the tree, in temporary trees with invented packages and compilers.

usage: launcher_test.py LAUNCHER [unittest options]
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

LAUNCHER = pathlib.Path(sys.argv.pop(1)).resolve()
ROOT = LAUNCHER.parent

# Every invented tool first writes down how it was called.
NOTE = '#!/bin/bash\nprintf "%s\\n" "$(basename "$0") $*" >> "$CALLS"\n'

# Knows every package but those of $MISSING, as dpkg-query does: known ones on standard output.
DPKG_QUERY = NOTE + r"""
status=0
for package in "${@:3}"; do
  if [[ " $MISSING " == *" $package "* ]]; then
    status=1
  elif [[ $2 == *Package* ]]; then
    printf 'installed %s\n' "$package"
  else
    printf installed
  fi
done
exit $status
"""

# Fails as apt does where another one holds its lists, as often as $LOCKED holds a line.
APT_GET = NOTE + r"""
if [[ -s $LOCKED ]]; then
  sed -i 1d "$LOCKED"
  echo 'E: Could not get lock /var/lib/apt/lists/lock. It is held by process 7 (apt-get)'
  exit 100
fi
"""

CMAKE = NOTE + r"""
build=$HERE/build/release
mkdir -p "$build"
tests=OFF
[[ $* != *ISOLINE_TESTS=ON* ]] || tests=ON
printf '%s\n' "CMAKE_HOME_DIRECTORY:INTERNAL=$HERE" "ISOLINE_TESTS:BOOL=$tests" \
  > "$build/CMakeCache.txt"
touch "$build/build.ninja"
"""

# Fails with the words of $ERRORS where there are any, and else makes the program.
NINJA = NOTE + r"""
if [[ -n $ERRORS ]]; then cat "$ERRORS"; exit 1; fi
echo '[1/1] Building CXX object x.o'
printf '#!/bin/bash\necho "program $*"\n' > "$HERE/build/release/isoline"
chmod +x "$HERE/build/release/isoline"
"""

TOOLS = {'dpkg-query': DPKG_QUERY, 'apt-get': APT_GET, 'cmake': CMAKE, 'ninja': NINJA,
         'ctest': NOTE, 'sleep': NOTE, 'sudo': '#!/bin/bash\n[[ $1 == -n ]] || exec "$@"\n'}


def write_program(path, text):
    path.write_text(text)
    path.chmod(0o755)


class Tree:
    """A folder with the launcher alone, and the invented tools in front of the true ones."""

    def __init__(self, folder, tools=tuple(TOOLS)):
        self.path = folder / 'a tree'
        self.path.mkdir()
        self.calls_file = folder / 'calls'
        self.locked = folder / 'locked'
        self.bin = folder / 'bin'
        self.bin.mkdir()
        shutil.copy(LAUNCHER, self.path / 'isoline')
        for name in ('debian/control', 'tests/kernels.sh'):
            (self.path / name).parent.mkdir()
            shutil.copy(ROOT / name, self.path / name)
        for name in tools:
            write_program(self.bin / name, TOOLS[name])
        self.environment = {**os.environ, 'PATH': f'{self.bin}:{os.environ["PATH"]}',
                            'CALLS': str(self.calls_file), 'HERE': str(self.path), 'MISSING': '',
                            'LOCKED': str(self.locked), 'ERRORS': ''}
        self.environment.pop('ISOLINE_PRESET', None)

    def run(self, *arguments, **environment):
        self.calls_file.write_text('')
        return subprocess.run([self.path / 'isoline', *arguments], capture_output=True, text=True,
                              env={**self.environment, **environment}, stdin=subprocess.DEVNULL)

    def calls(self, tool=''):
        return [line for line in self.calls_file.read_text().splitlines()
                if line.startswith(tool)]


class WithTree(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)


class Questions(WithTree):
    """What the program answers by itself neither installs nor builds."""

    QUESTIONS = [('--help',), ('-h',), ('--version',), ('help', 'run'), ('version',), ('describe',),
                 ('describe', 'problems'),
                 ('completion', 'bash'), ('man',), ('run', '--help'), ()]

    def test_an_existing_program_answers_them_alone(self):
        tree = Tree(self.folder)
        tree.run('run')
        for question in self.QUESTIONS:
            result = tree.run(*question, MISSING='libfftw3-dev')
            self.assertEqual(result.stdout, f'program {" ".join(question)}\n')
            self.assertEqual(tree.calls(), [], question)

    def test_help_on_tests_needs_no_program(self):
        tree = Tree(self.folder)
        result = tree.run('test', '--help')
        self.assertIn('--kernels', result.stdout)
        self.assertEqual(tree.calls(), [])

    def test_without_a_program_they_build_it(self):
        tree = Tree(self.folder)
        self.assertEqual(tree.run('--help').stdout, 'program --help\n')
        self.assertTrue(tree.calls('ninja'))

    def test_any_other_verb_builds_what_is_stale(self):
        tree = Tree(self.folder)
        tree.run('run')
        for arguments in [('run', 'quick'), ('describe', 'sip'), ('run', '--', '--help')]:
            self.assertEqual(tree.run(*arguments).stdout, f'program {" ".join(arguments)}\n')
            self.assertTrue(tree.calls('ninja'), arguments)

    def test_a_list_older_than_the_sources_says_so(self):
        tree = Tree(self.folder)
        tree.run('run')
        (tree.path / 'problems').mkdir()
        newer = tree.path / 'problems' / 'mine.cpp'
        newer.touch()
        program = tree.path / 'build' / 'release' / 'isoline'
        os.utime(newer, (program.stat().st_mtime + 5,) * 2)
        result = tree.run('describe')
        self.assertEqual(result.stdout, 'program describe\n')
        self.assertIn('problems/mine.cpp is newer', result.stderr)
        self.assertEqual(tree.run('completion', 'bash').stderr, '')


class Container(unittest.TestCase):
    """The container file builds as the page about clusters does, with packages of the launcher."""

    def test_its_commands_are_those_of_the_page(self):
        root = LAUNCHER.parent
        build, run = (root / 'Containerfile').read_text('utf-8').split('\n\nFROM ')
        commands = re.findall(r'^RUN (.*)$', build, re.M)
        page = (root / 'docs' / 'on-a-cluster.md').read_text('utf-8')
        [shown] = re.findall(r'^```\n(ISOLINE_PRESET=portable .*?)^```$', page, re.M | re.S)
        plan, pack, install = shown.splitlines()
        self.assertEqual([commands[0], commands[-1]], [plan, pack])
        [tools] = re.findall(r'install -y --no-install-recommends (.*)', commands[1])
        for tool in tools.split():
            self.assertIn(f'\n {tool}', (root / 'debian/control').read_text('utf-8'))
        self.assertEqual(pack.split()[-1], 'build')
        self.assertIn(f'COPY --from=build /isoline/{install.split("./")[-1]} /tmp/', run)
        self.assertRegex(run, r'RUN apt-get update && apt-get install .* /tmp/isoline_\*\.deb ')


class Packages(WithTree):
    def test_one_question_for_all_of_them(self):
        tree = Tree(self.folder)
        tree.run('run')
        self.assertEqual(len(tree.calls('dpkg-query')), 1)
        self.assertEqual(tree.calls('apt-get'), [])

    def test_what_is_missing_alone_is_installed_and_told_with_its_purpose(self):
        tree = Tree(self.folder)
        result = tree.run('run', MISSING='libfftw3-dev libdnnl-dev')
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stderr, r'libfftw3-dev +Fourier transforms')
        self.assertNotIn('libeigen3-dev', result.stderr)
        install = tree.calls('apt-get')[-1]
        self.assertRegex(install, '--no-install-recommends libfftw3-dev libdnnl-dev$')

    def test_tests_ask_for_their_own_packages_too(self):
        tree = Tree(self.folder)
        tree.run('run', MISSING='libgtest-dev')
        self.assertEqual(tree.calls('apt-get'), [])
        tree.run('test', MISSING='libgtest-dev')
        self.assertTrue(tree.calls('apt-get'))

    def test_dpkgs_lock_is_waited_for(self):
        tree = Tree(self.folder)
        tree.run('run', MISSING='libfftw3-dev')
        for call in tree.calls('apt-get'):
            self.assertRegex(call, r'-o DPkg::Lock::Timeout=[1-9]\d+')

    def test_the_lock_of_the_lists_is_waited_for_too(self):
        tree = Tree(self.folder)
        tree.locked.write_text('once\ntwice\n')
        result = tree.run('run', MISSING='libfftw3-dev')
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr.count('waiting for it'), 1)
        self.assertEqual(len(tree.calls('sleep')), 2)

    def test_a_lock_that_is_never_free_ends_in_an_error(self):
        tree = Tree(self.folder)
        tree.locked.write_text('always\n' * 10000)
        result = tree.run('run', MISSING='libfftw3-dev')
        self.assertEqual(result.returncode, 1)
        self.assertIn('Could not get lock', result.stderr)
        self.assertEqual(tree.calls('ninja'), [])


class Waiting(WithTree):
    """Without a terminal a long installation and a long build print a line per interval."""

    def test_an_installation_and_a_build_are_reported_while_they_go_on(self):
        tree = Tree(self.folder)
        launcher = tree.path / 'isoline'
        launcher.write_text(launcher.read_text().replace('interval=60 ', 'interval=1 '))
        wait = 'read -r -t 2.5 <> <(:) || true\n'
        write_program(tree.bin / 'apt-get', NOTE + wait)
        write_program(tree.bin / 'ninja', NINJA.replace('echo', 'echo "[2/9] Building CXX object y.o"\n'
                                                        + wait + 'echo', 1))
        result = tree.run('run', MISSING='libdnnl-dev')
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('installing packages (1 min)', result.stderr)
        self.assertIn('building [2/9]', result.stderr)


class Arguments(WithTree):
    def test_all_are_handed_to_the_program(self):
        tree = Tree(self.folder)
        self.assertEqual(tree.run('run', '--problem', 'a b').stdout, 'program run --problem a b\n')

    def test_all_of_test_are_handed_to_ctest(self):
        tree = Tree(self.folder)
        tree.run('test', '-R', 'core', '--stop-on-failure')
        self.assertRegex(tree.calls('ctest')[0], '-R core --stop-on-failure$')
        self.assertIn('-DISOLINE_TESTS=ON', tree.calls('cmake')[0])

    def test_kernels_are_named_by_the_table(self):
        result = Tree(self.folder).run('test', '--kernels', 'nobody')
        self.assertEqual(result.returncode, 1)
        self.assertIn("no row 'nobody'; ", result.stderr)
        self.assertIn(' haswell ', result.stderr)

    def test_fuzzers_are_built_apart_and_handed_to_ctest(self):
        tree = Tree(self.folder)
        tree.run('test', '--fuzz', '-R', 'npy')
        self.assertIn('--preset fuzz', tree.calls('cmake')[0])
        self.assertRegex(tree.calls('ctest')[0], 'build/fuzz .*-R npy$')

    def test_tests_once_on_stay_on(self):
        tree = Tree(self.folder)
        tree.run('test')
        tree.run('run')
        self.assertEqual(tree.calls('cmake'), [])

    def test_a_link_to_the_launcher_finds_the_tree(self):
        tree = Tree(self.folder)
        (self.folder / 'link').symlink_to(tree.path / 'isoline')
        result = subprocess.run([self.folder / 'link', 'run'], capture_output=True, text=True,
                                env=tree.environment, cwd=self.folder)
        self.assertEqual(result.stdout, 'program run\n')


# What ninja prints: a warning first, a file with two errors, then another that failed beside it.
COMPILER = """[1/9] Building CXX object a.o
/t/a.cpp:3:5: warning: unused variable 'early' [-Wunused-variable]
[2/9] Building CXX object b.o
FAILED: b.o
/usr/bin/c++ -o b.o -c /t/b.cpp
In file included from /t/b.cpp:2:
/t/b.h: In function 'int f()':
/t/b.h:7:3: error: 'theta' was not declared in this scope
    7 |   theta = 1;
      |   ^~~~~
/t/b.cpp:9:9: error: the second error
""" + ''.join(f'/t/b.cpp:{n}:1: note: candidate {n}\n' for n in range(60)) + """\
[3/9] Building CXX object c.o
ninja: build stopped: subcommand failed.
"""

LINKER = """[8/9] Linking CXX executable isoline
FAILED: isoline
: && /usr/bin/c++ main.o -o isoline
/usr/bin/ld: libisoline_problems.a(registry.cpp.o): in function `isoline::problems::register_problems(isoline::Registry<isoline::problems::ProblemEntry>&)':
registry.cpp:(.text+0x9): undefined reference to `isoline::problems::register_half_done(isoline::Registry<isoline::problems::ProblemEntry>&)'
collect2: error: ld returned 1 exit status
ninja: build stopped: subcommand failed.
"""


# Writes down its kernel and its threads; fails where it is the one of $FAILING.
NUMERICAL_TEST = r"""#!/bin/bash
echo "$(basename "$0") $OPENBLAS_CORETYPE $ISOLINE_TEST_THREADS" >> "$CALLS"
if [[ "$OPENBLAS_CORETYPE $(basename "$0")" == "$FAILING" ]]; then
  echo '[  FAILED  ] Sums.AreSums (3 ms)'
  exit 1
fi
"""


class Kernels(WithTree):
    """The numerical tests, row by row; every processor that runs this has SSE3."""

    PROGRAMS = ('core_tests', 'networks_tests', 'problems_tests', 'optimizers_tests')

    def setUp(self):
        super().setUp()
        self.tree = Tree(self.folder)
        tests = self.tree.path / 'build/release/tests'
        tests.mkdir(parents=True)
        for program in self.PROGRAMS:
            write_program(tests / program, NUMERICAL_TEST)

    def run_rows(self, *rows, failing=''):
        return self.tree.run('test', '--kernels', *rows, FAILING=failing)

    def test_a_row_is_run_on_one_and_on_two_threads(self):
        result = self.run_rows('prescott')
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout.splitlines()[-1], '2 passed, 0 failed, 0 skipped')
        calls = [call for call in self.tree.calls() if '_tests Prescott' in call]
        rooms = len(self.PROGRAMS)  # side by side, in any order
        for threads, made in ((1, calls[:rooms]), (2, calls[rooms:])):
            self.assertEqual(sorted(made), sorted(f'{program} Prescott {threads}'
                                                  for program in self.PROGRAMS))

    def test_one_failure_fails_the_row_and_is_named(self):
        result = self.run_rows('prescott', failing='Prescott networks_tests')
        self.assertEqual(result.returncode, 1)
        self.assertIn('Sums.AreSums', result.stdout)
        self.assertEqual(result.stdout.splitlines()[-1], '0 passed, 2 failed, 0 skipped')

    def test_a_name_of_no_row_is_refused_before_anything_is_built(self):
        result = self.run_rows('pentium')
        self.assertEqual(result.returncode, 1)
        self.assertIn("no row 'pentium'; ", result.stderr)
        self.assertEqual(self.tree.calls('ninja'), [])


class Failures(WithTree):
    def run_with(self, words):
        errors = self.folder / 'errors'
        errors.write_text(words)
        return Tree(self.folder).run('run', ERRORS=str(errors))

    def test_the_first_compiler_error_is_shown_and_no_other(self):
        result = self.run_with(COMPILER)
        self.assertEqual(result.returncode, 1)
        self.assertIn("b.h:7:3: error: 'theta' was not declared", result.stderr)
        self.assertIn('In file included from /t/b.cpp:2:', result.stderr)
        self.assertIn('theta = 1;', result.stderr)
        for word in ['second error', 'candidate', "'early'", '/usr/bin/c++']:
            self.assertNotIn(word, result.stderr)

    def test_a_component_without_its_function_is_named(self):
        result = self.run_with(LINKER)
        self.assertEqual(result.returncode, 1)
        self.assertIn('problems/half_done.cpp must define register_half_done', result.stderr)

    def test_an_error_of_unknown_words_is_shown_by_the_end_of_the_log(self):
        result = self.run_with('something else\n')
        self.assertIn('something else', result.stderr)
        self.assertIn('build.log', result.stderr)


# A true program of one file, to be built by the true tools.
PROJECT = {
    'CMakeLists.txt': 'cmake_minimum_required(VERSION 3.25)\nproject(small LANGUAGES CXX)\n'
                      'option(ISOLINE_TESTS "" OFF)\nadd_executable(isoline main.cpp)\n',
    'CMakePresets.json': '{"version": 6, "configurePresets": [{"name": "release",'
                         ' "generator": "Ninja",'
                         ' "binaryDir": "${sourceDir}/build/${presetName}"}]}',
    'main.cpp': '#include <cstdio>\nint main() { std::puts("the first place"); }\n'}


class MovedTrees(WithTree):
    def make(self):
        tree = Tree(self.folder, tools=['dpkg-query'])
        for name, text in PROJECT.items():
            (tree.path / name).write_text(text)
        self.assertEqual(tree.run('run').stdout, 'the first place\n')
        return tree

    def test_a_copy_builds_its_own_sources(self):
        tree = self.make()
        copy = self.folder / 'copy'
        shutil.copytree(tree.path, copy)
        (copy / 'main.cpp').write_text(PROJECT['main.cpp'].replace('first', 'second'))
        result = subprocess.run([copy / 'isoline', 'run'], capture_output=True, text=True,
                                env=tree.environment)
        self.assertEqual(result.stdout, 'the second place\n', result.stderr)
        self.assertIn(f'this tree was at {tree.path}', result.stderr)

    def test_a_moved_tree_is_built_and_not_again_after_that(self):
        tree = self.make()
        tree.path = tree.path.rename(self.folder / 'moved')
        first = tree.run('run')
        self.assertEqual(first.stdout, 'the first place\n', first.stderr)
        self.assertEqual(tree.run('run').stderr, '')

    def test_an_error_of_the_true_compiler_is_shown(self):
        tree = self.make()
        (tree.path / 'main.cpp').write_text('int main() { return missing; }\n')
        result = tree.run('run')
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"main.cpp:1:\d+: error: .missing. was not declared")


@unittest.skipUnless((ROOT / 'cmake' / 'Components.cmake').exists(), 'a launcher without its tree')
class Components(WithTree):
    """cmake/Components.cmake, by the true CMake, over an invented room."""

    def configure(self, files):
        (self.folder / 'CMakeLists.txt').write_text(
            'cmake_minimum_required(VERSION 3.25)\nproject(small LANGUAGES CXX)\n'
            f'set(PROJECT_SOURCE_DIR "{ROOT}")\ninclude("{ROOT}/cmake/Components.cmake")\n'
            'add_subdirectory(problems)\n')
        room = self.folder / 'problems'
        for name, text in files.items():
            (room / name).parent.mkdir(parents=True, exist_ok=True)
            (room / name).write_text(text)
        (room / 'CMakeLists.txt').write_text(
            'isoline_components(problems ENTRY ProblemEntry HEADER problems/problem.h\n'
            '                   CORE problem.cpp)\n')
        result = subprocess.run(['cmake', '-G', 'Ninja', '-S', self.folder,
                                 '-B', self.folder / 'build'], capture_output=True, text=True)
        registry = self.folder / 'build' / 'problems' / 'registry.cpp'
        return result, registry.read_text() if registry.exists() else ''

    COMPLETE = {'problem.cpp': '', 'heat.cpp': 'void register_heat(ProblemRegistry& r) {}\n',
                'fluid/karman.cpp': 'void register_karman(ProblemRegistry& r) {}\n',
                'fluid/grid.cpp': 'int cells() { return 1; }\n'}

    def test_every_file_of_the_room_and_those_below_that_register_are_called(self):
        result, registry = self.configure(self.COMPLETE)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('register_heat(registry);', registry)
        self.assertIn('register_karman(registry);', registry)
        self.assertNotIn('register_grid', registry)
        self.assertNotIn('register_problem(', registry)

    def test_a_file_without_its_function_is_named_before_anything_is_compiled(self):
        result, _ = self.configure({**self.COMPLETE, 'half_done.cpp': 'int nothing;\n'})
        self.assertNotEqual(result.returncode, 0)
        self.assertIn('problems/half_done.cpp must define register_half_done',
                      ' '.join(result.stderr.split()))


if __name__ == '__main__':
    unittest.main(verbosity=2)
