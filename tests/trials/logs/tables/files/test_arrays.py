"""MATLAB and HDF5 files: structs and groups of arrays. SciPy and h5py write what is read here."""

import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from shipid.foundation.errors import MissingExtraError
from shipid.trials import errors as e
from shipid.trials.logs.reading import read_trial
from shipid.trials.logs.tables.files import hdf5, matlab
from shipid.trials.logs.tables.files.arrays import Array, Unreadable
from shipid.trials.logs.tables.files.matlab import matlab_arrays


@pytest.fixture
def columns(sample):
    return {name: sample[name].to_numpy() for name in sample}


@pytest.fixture
def mat(tmp_path):
    def write(content, **options):
        path = tmp_path / "log.mat"
        savemat(path, content, **options)
        return path

    return write


class TestMatlab:
    @pytest.mark.parametrize("options", [{}, {"do_compression": True}, {"oned_as": "column"}, {"format": "4"}])
    def test_variables(self, mat, columns, bare, same, options):
        assert same(read_trial(mat(columns, **options), bare()))

    @pytest.mark.parametrize("compressed", [False, True])
    def test_a_struct_among_others(self, mat, columns, bare, same, compressed):
        content = {"trial": columns, "note": "psi in degrees", "L": 50.0, "flags": np.array([True, False])}
        assert same(read_trial(mat(content, do_compression=compressed), bare()))

    def test_units_in_fields(self, mat, columns, units, same):
        assert same(read_trial(mat({"trial": {**columns, "units": units}})))
        assert same(read_trial(mat({**columns, **{f"{name}_unit": unit for name, unit in units.items()}})))
        listed = np.array(list(units.values()), dtype=object)
        assert same(read_trial(mat({"trial": {**columns, "units": listed}})))

    def test_without_units_it_is_refused(self, mat, columns):
        with pytest.raises(e.NoUnitError, match=r"struct 'trial', column '\w+' says no unit"):
            read_trial(mat({"trial": columns}))

    def test_one_of_several_structs_has_to_be_named(self, mat, columns, bare, same):
        path = mat({"run1": columns, "run2": {**columns, "delta": -columns["delta"]}, "deep": {"run3": columns}})
        with pytest.raises(
            e.ChoiceError, match=r"3 tables: 'run1', 'run2', 'deep/run3'\. Name the struct .*log\.mat#run1"
        ):
            read_trial(path, bare())
        assert same(read_trial(f"{path}#run1", bare()))
        assert same(read_trial(f"{path}#deep/run3", bare()))
        assert read_trial(path, bare('[table]\nstruct = "run2"\n'))["delta"][-1] < 0

    def test_a_matrix_with_names_and_one_without(self, mat, sample, units, tmp_path, same):
        names = np.array([f"{name} [{unit}]" for name, unit in units.items()], dtype=object)
        assert same(read_trial(mat({"data": sample.to_numpy(), "names": names})))
        assert same(read_trial(mat({"data": sample.to_numpy().T, "names": names})))
        fmt = tmp_path / "index.toml"
        fmt.write_text("".join(f'[columns.{n}]\nindex = {k}\nunit = "{u}"\n' for k, (n, u) in enumerate(units.items())))
        assert same(read_trial(mat({"data": sample.to_numpy()}), fmt))

    def test_a_struct_array_of_samples(self, mat, sample, bare, same):
        kinds = [(name, object) for name in sample]
        assert same(
            read_trial(mat({"trial": np.array([tuple(row) for row in sample.to_numpy()], dtype=kinds)}), bare())
        )

    def test_kinds_of_numbers(self, mat, columns):
        made = {f"n{k}": np.arange(5).astype(k) for k in ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8")}
        path = mat({**made, "text": "déjà", "many": np.array(["ab", "cde"], dtype=object), "z": np.arange(3) * 1j})
        found = matlab_arrays(path.read_bytes(), path)
        for name in made:
            np.testing.assert_array_equal(found[name].values.reshape(-1), np.arange(5))
        assert found["text"].values.tolist() == ["déjà"] and found["many"].values.tolist() == ["ab", "cde"]
        assert isinstance(found["z"], Unreadable) and isinstance(found["ni8"], Array)

    def test_columns_of_other_lengths_are_left_out_and_named(self, mat, columns, bare):
        trial = read_trial(mat({**columns, "gps": np.arange(7.0)}), bare())
        assert any("left out: 'gps'" in note for note in trial.source.notes)

    def test_damaged_files_are_named(self, mat, columns, log):
        data = mat({"trial": columns}).read_bytes()
        sizes = bytearray(data)
        sizes[128 + 4 : 128 + 8] = struct.pack("<I", 2**31)
        for broken in (data[:400], data[:-200], bytes(sizes), data[:126] + b"XX" + data[128:]):
            with pytest.raises(e.DamagedFileError, match="damaged MATLAB file"):
                read_trial(log(broken, "log.mat"))
        with pytest.raises(e.DamagedFileError, match="damaged MATLAB file"):
            read_trial(log(struct.pack("<5i", 0, 10**6, 10**6, 0, 2) + b"t\0" + bytes(100), "log.mat"))

    def test_what_a_compressed_variable_expands_to_is_bounded(self, mat, monkeypatch):
        path = mat({"t": np.zeros(100_000), "psi": np.zeros(100_000)}, do_compression=True)
        monkeypatch.setattr(matlab, "LARGEST", 1_000_000)
        with pytest.raises(e.FileSizeError, match="expands to more than 1 MB"):
            read_trial(path)

    def test_no_table(self, mat):
        with pytest.raises(e.EmptyFileError, match=r"no struct with two or more columns of numbers.* in 'L', 'name'"):
            read_trial(mat({"L": 50.0, "name": "Alpha"}))


class TestHdf5:
    @pytest.fixture
    def write(self, tmp_path):
        h5py = pytest.importorskip("h5py")

        def write(name="log.h5", **groups):
            path = tmp_path / name
            with h5py.File(path, "w") as file:
                for group, (columns, units) in groups.items():
                    for column, values in columns.items():
                        made = file.create_dataset(f"{group.strip('_')}/{column}", data=values, compression="gzip")
                        if column in units:
                            made.attrs["units"] = units[column]
            return path

        return write

    def test_groups(self, write, columns, units, same):
        assert same(read_trial(write(run=(columns, units))))
        assert same(read_trial(write(_=(columns, units))))
        path = write(r1=(columns, units), r2=(columns, units))
        with pytest.raises(e.ChoiceError, match=r"2 tables: 'r1', 'r2'. Name the group"):
            read_trial(path)
        assert same(read_trial(f"{path}#r2"))

    def test_records_and_matrices_with_names(self, sample, units, tmp_path, same):
        h5py = pytest.importorskip("h5py")
        names = [f"{name} [{unit}]" for name, unit in units.items()]
        with h5py.File(tmp_path / "a.h5", "w") as file:
            file["table"] = sample.set_axis(names, axis=1).to_records(index=False)
        with h5py.File(tmp_path / "b.h5", "w") as file:
            file["table"] = sample.to_numpy()
            file["table"].attrs["columns"] = names
        assert same(read_trial(tmp_path / "a.h5")) and same(read_trial(tmp_path / "b.h5"))

    def test_matlab_7_3(self, columns, units, tmp_path, same):
        h5py = pytest.importorskip("h5py")
        path = tmp_path / "log.mat"
        with h5py.File(path, "w", userblock_size=512) as file:
            for name, values in columns.items():
                file[f"trial/{name}"] = values.reshape(1, -1)
                file[f"trial/{name}"].attrs["MATLAB_class"] = np.bytes_("double")
                text = np.array([[ord(letter)] for letter in units[name]], dtype=np.uint16)
                file[f"trial/units/{name}"] = text
                file[f"trial/units/{name}"].attrs["MATLAB_class"] = np.bytes_("char")
        data = bytearray(path.read_bytes())
        data[:116] = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116)
        path.write_bytes(bytes(data))
        assert same(read_trial(path))

    def test_links_to_other_files_are_not_followed(self, write, columns, units, tmp_path):
        h5py = pytest.importorskip("h5py")
        write(run=(columns, units))
        with h5py.File(tmp_path / "link.h5", "w") as file:
            file["run"] = h5py.ExternalLink(str(tmp_path / "log.h5"), "run")
        with pytest.raises(e.EmptyFileError, match="no group with two or more columns"):
            read_trial(tmp_path / "link.h5")

    def test_arrays_that_claim_too_much_are_refused(self, tmp_path):
        h5py = pytest.importorskip("h5py")
        with h5py.File(tmp_path / "huge.h5", "w") as file:
            for name in ("t", "psi"):
                file.create_dataset(name, shape=(10**10,), dtype="f8", chunks=(1000,))
        with pytest.raises(e.FileSizeError, match="arrays of more than 256 MB"):
            read_trial(tmp_path / "huge.h5")

    def test_damaged_files_are_named(self, write, columns, units, log):
        data = write(run=(columns, units)).read_bytes()
        with pytest.raises(e.DamagedFileError, match="damaged HDF5 file"):
            read_trial(log(data[:1000], "log.h5"))

    def test_damage_that_crashes_the_library_is_told_like_any_other(self, tmp_path, log):
        h5py = pytest.importorskip("h5py")
        with h5py.File(tmp_path / "sound.h5", "w") as file:
            for name, unit in (("t", "s"), ("psi", "deg")):
                file[name] = np.arange(4.0)
                file[name].attrs["units"] = unit
        data = (tmp_path / "sound.h5").read_bytes()
        # The unit is a sequence of variable length; its kind, a text, becomes one that there is not.
        broken = data.replace(b"units\0\0\0\x19\x01", b"units\0\0\0\x19\x28", 1)
        assert broken != data
        with pytest.raises(e.DamagedFileError, match=r"'.*log\.h5' is a damaged HDF5 file"):
            read_trial(log(broken, "log.h5"))

    @pytest.mark.parametrize(
        "instead",
        [
            "import os; print(flush=True); os.abort()",
            "print('\\n{', flush=True)",
            "print('\\n{\"array\": 0}', flush=True)",
            'print(\'\\n{"group": {"t": {"array": 7}}}\', flush=True)',
            "import time; print(flush=True); time.sleep(600)",
        ],
    )
    def test_a_reader_that_crashes_stops_halfway_or_hangs(self, write, columns, units, tmp_path, monkeypatch, instead):
        path = write(run=(columns, units))
        monkeypatch.setattr(hdf5, "_READER", tmp_path / "reader.py")
        monkeypatch.setattr(hdf5, "_LONGEST", 1.0 if "sleep" in instead else 60.0)
        (tmp_path / "reader.py").write_text(instead)
        with pytest.raises(e.DamagedFileError, match="damaged HDF5 file"):
            read_trial(path)

    def test_no_objects_are_made_of_what_the_reader_says(self, write, columns, units, tmp_path, monkeypatch):
        path = write(run=(columns, units))
        monkeypatch.setattr(hdf5, "_READER", tmp_path / "reader.py")
        (tmp_path / "reader.py").write_text(
            "import sys, numpy as np\n"
            "print('\\n{\"group\": {}}', flush=True)\n"
            "np.save(sys.stdout.buffer, np.array([print], dtype=object), allow_pickle=True)\n"
        )
        with pytest.raises(e.DamagedFileError, match="damaged HDF5 file"):
            read_trial(path)

    @pytest.mark.parametrize(("python", "reason"), [("", "could not be started"), (sys.executable, "exit code 7")])
    def test_a_reader_that_cannot_be_started(self, write, columns, units, tmp_path, monkeypatch, python, reason):
        path = write(run=(columns, units))
        monkeypatch.setattr(sys, "executable", python)
        monkeypatch.setattr(hdf5, "_READER", tmp_path / "reader.py")
        (tmp_path / "reader.py").write_text("raise SystemExit(7)")
        with pytest.raises(e.ReaderNotStartedError, match=rf"was not read.*{reason}.*Write the table as CSV"):
            read_trial(path)

    def test_what_the_reader_may_take_is_bounded(self):
        code = "import sys, hdf5_apart; hdf5_apart.bound(10**9, 1)\n"
        for greedy in ("bytearray(2 * 10**9)", "while True: pass"):
            pytest.importorskip("resource")
            command = [sys.executable, "-c", code + greedy]
            ended = subprocess.run(
                command, cwd=Path(hdf5.__file__).parent, capture_output=True, timeout=60, check=False
            )
            assert ended.returncode != 0

    def test_a_text_that_needs_too_much_memory_and_arrays_of_arrays(self, write, columns, units, tmp_path, same):
        h5py = pytest.importorskip("h5py")
        path = write(run=(columns, units))
        with h5py.File(path, "a") as file:
            odd = file["run"].create_dataset("odd", (3,), dtype=h5py.vlen_dtype("f8"))
            odd[0] = [1.0, 2.0]
        assert same(read_trial(path))
        with h5py.File(path, "a") as file:
            # As an array of texts, each as long as the longest, this is 400 GB.
            file["run/note"] = ["x" * 10**6] + ["y"] * 10**5
        with pytest.raises(e.FileSizeError, match="arrays of more than 256 MB"):
            read_trial(path)

    def test_without_h5py_it_says_what_to_install(self, write, columns, units, monkeypatch):
        path = write(run=(columns, units))
        monkeypatch.setitem(__import__("sys").modules, "h5py", None)
        with pytest.raises(MissingExtraError, match=r"pip install 'shipid\[hdf5\]'"):
            read_trial(path)
        assert hdf5.LARGEST == matlab.LARGEST


def test_time_that_counts_since_a_date(tmp_path):
    """As climate and ocean data write it."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "log.nc", "w") as file:
        for name, values, unit in (
            ("t", np.arange(20.0), "seconds since 2026-05-04 13:59:50"),
            ("psi", np.arange(20.0), "degrees"),
        ):
            file[name] = values
            file[name].attrs["units"] = unit
    trial = read_trial(tmp_path / "log.nc")
    assert trial["t"][-1] == 19
    assert "'t' counts seconds since 2026-05-04 13:59:50." in trial.source.notes
