# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes that the export cannot read are refused by name, not read as 0."""

import pytest
from etalon.lib.errors import Refused


@pytest.mark.parametrize(("kind", "domain"), [("INT8", "POINT"), ("QUATERNION", "POINT"), ("FLOAT", "EDGE")])
def test_an_attribute_of_a_type_or_domain_that_is_not_read_is_refused(studio, kind, domain):
    quad = studio.quad()
    quad.data.attributes.new("heat", kind, domain)
    node = studio.probe_material("ShaderNodeAttribute", "Color")
    next(n for n in node.node_tree.nodes if n.bl_idname == "ShaderNodeAttribute").attribute_name = "heat"
    quad.data.materials[0] = node
    with pytest.raises(Refused, match=rf"attribute 'heat' of type {kind.lower()} on domain {domain.lower()}"):
        studio.export()
