"""Files on disk: whole or not at all, checked field by field, and with the versions that wrote them."""
