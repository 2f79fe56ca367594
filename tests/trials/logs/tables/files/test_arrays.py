"""MATLAB and HDF5 files: structs and groups of arrays. SciPy and h5py write what is read here."""

import struct

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

    def test_without_h5py_it_says_what_to_install(self, write, columns, units, monkeypatch):
        path = write(run=(columns, units))
        monkeypatch.setitem(__import__("sys").modules, "h5py", None)
        with pytest.raises(MissingExtraError, match=r"pip install 'shipid\[hdf5\]'"):
            read_trial(path)
        assert hdf5.LARGEST == matlab.LARGEST
