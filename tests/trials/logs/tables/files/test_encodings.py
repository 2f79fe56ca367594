"""Texts that are no Unicode: read by their letters where these leave no doubt."""

import numpy as np
import pytest

from shipid.trials.logs.reading import read_trial
from shipid.trials.logs.tables.files.encodings import legacy_encoding

HEADERS = {
    "cp932": "時刻 [s],船首方位 [deg],舵角 [deg]",
    "gb18030": "时间 [s],航向 [deg],舵角 [deg]",
    "cp1251": "Время [s],Курс [deg],Перо руля [deg]",
    "cp1252": "Zeit [s],Kurs über Grund [°],Ruderwinkel für Steuerbord [°],Größe [m],Länge [°]",
}
WESTERN = (
    "Temps [s],Cap [degrés],Vitesse réelle [nœuds],Côté bâbord,Échelle",
    "Tiempo [s],Ángulo de timón [°],Dirección,Señal,Año",
    "Tid [s],Rorvinkel på styrbord [°],Høyde,Størrelse",
    "Tempo [s],Velocità,Profondità [m],Città,Età",
    "Zeit [s],psi [°],r [°/s],delta [°],phi [°],theta [°]",
)


@pytest.mark.parametrize("encoding", HEADERS)
def test_by_its_letters(encoding):
    assert legacy_encoding((HEADERS[encoding] + "\n0,1,2\n").encode(encoding)) == encoding


@pytest.mark.parametrize("text", WESTERN)
def test_western_texts_stay_western(text):
    assert legacy_encoding((text + "\n0,1,2\n").encode("cp1252")) == "cp1252"


def test_a_log_in_shift_jis(log):
    rows = "".join(f"{k},{10 + k},0\n" for k in range(20))
    trial = read_trial(log(("時刻 [s],psi [deg],舵角 [deg]\n" + rows).encode("cp932")))
    assert np.degrees(trial["psi"][-1]) == pytest.approx(29)
    assert trial.has("舵角")
    assert any("read as cp932" in str(note) for note in trial.source.notes)
