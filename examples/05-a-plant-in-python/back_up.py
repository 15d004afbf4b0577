"""back_up.py: makes a backup, and compares every byte of it with its checksums."""
import plant
from graspdb.v1 import backup_service_pb2, backup_service_pb2_grpc


def last(stream):
    """The backup of a stream's last message; those before it report the progress."""
    for response in stream:
        pass
    return response.backup


def main():
    backups = backup_service_pb2_grpc.BackupServiceStub(plant.connect("engineer"))
    backup = last(backups.CreateBackup(backup_service_pb2.CreateBackupRequest()))
    last(backups.VerifyBackup(backup_service_pb2.VerifyBackupRequest(name=backup.name)))
    print(f"{backup.name}: revision {backup.catalog_revision}, {backup.view_count} views, {backup.byte_count} bytes")


main()
