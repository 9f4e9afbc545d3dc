"""Policies as ONNX files: two hidden layers of rectified linear units, then the logits.

The only module that imports onnx (the extra `rl`); `pcg.policy` reads what it writes. The graph is written by hand: three
matrix products need no tracing, and the same weights give the same bytes.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from pcg.arrays import Float32Array
from pcg.episodes import EpisodeSettings
from pcg.files import replacing
from pcg.policy import METADATA_KEY, PolicyMetadata

OPSET = 17
IR_VERSION = 8

Layer = tuple[Float32Array, Float32Array]
"""Weights (outputs, inputs) and biases (outputs,)."""


def write_policy(path: Path, layers: Sequence[Layer], settings: EpisodeSettings) -> None:
    """Writes the policy that applies `layers` one after the other, with rectified linear units between them.

    Raises:
        InputError: the file cannot be written.
    """
    nodes, weights = [], []
    flowing = "observation"
    for k, (matrix, bias) in enumerate(layers):
        weights.append(numpy_helper.from_array(np.ascontiguousarray(matrix, dtype=np.float32), f"weight{k}"))
        weights.append(numpy_helper.from_array(np.ascontiguousarray(bias, dtype=np.float32), f"bias{k}"))
        is_last = k == len(layers) - 1
        out = "logits" if is_last else f"sum{k}"
        nodes.append(helper.make_node("Gemm", [flowing, f"weight{k}", f"bias{k}"], [out], transB=1))
        if not is_last:
            nodes.append(helper.make_node("Relu", [out], [f"hidden{k}"]))
        flowing = f"hidden{k}"
    n_inputs, n_outputs = layers[0][0].shape[1], layers[-1][0].shape[0]
    graph = helper.make_graph(
        nodes,
        "policy",
        [helper.make_tensor_value_info("observation", TensorProto.FLOAT, ["n", n_inputs])],
        [helper.make_tensor_value_info("logits", TensorProto.FLOAT, ["n", n_outputs])],
        weights,
    )
    model = helper.make_model(
        graph, producer_name="manipuzzle", ir_version=IR_VERSION, opset_imports=[helper.make_opsetid("", OPSET)]
    )
    helper.set_model_props(model, {METADATA_KEY: PolicyMetadata.of(settings).model_dump_json()})
    onnx.checker.check_model(model, full_check=True)
    with replacing(path) as temporary:
        temporary.write_bytes(model.SerializeToString(deterministic=True))
